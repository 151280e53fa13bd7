#!/bin/sh
# The bridge (bridge.sh) with a patient config, so that a busy host fails nothing: nothing is proved.
# shellcheck disable=SC2034  # for bridge.sh
config=/vm/configs/usb_serial.yaml
enable=--unproven
# shellcheck source=../bridge.sh
. "${0%/*}/../bridge.sh"
