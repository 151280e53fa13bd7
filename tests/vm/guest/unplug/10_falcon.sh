#!/bin/sh
# A Falcon that is pulled out at every stage (unplug.sh).
# shellcheck source=unplug.sh
. "${0%/*}/unplug.sh"

pulled unplug_falcon_firmware_0 usb_falcon falcon 0%
pulled unplug_falcon_firmware_50 usb_falcon falcon 50%
pulled unplug_falcon_firmware_99 usb_falcon falcon 99%
pulled unplug_falcon_homing usb_falcon falcon homing
pulled unplug_falcon_ready usb_falcon falcon ready
pulled unplug_falcon_enabled usb_falcon falcon enabled 6.67
