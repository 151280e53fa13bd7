#!/bin/sh
# The bridge (bridge.sh) with a certified wall, whose proof rests on times that a quiet host keeps.
# shellcheck disable=SC2034  # for bridge.sh
config=/vm/configs/usb_serial_certified.yaml
# shellcheck source=../bridge.sh
. "${0%/*}/../bridge.sh"
