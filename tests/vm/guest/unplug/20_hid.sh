#!/bin/sh
# A board with reports of its own and an OpenFFBoard, likewise (unplug.sh).
# shellcheck source=unplug.sh
. "${0%/*}/unplug.sh"

pulled unplug_report_set_up usb_report board set_up
pulled unplug_report_ready usb_report board ready
pulled unplug_report_enabled usb_report board enabled 1
pulled unplug_report_libusb_enabled usb_report_libusb board enabled 1
pulled unplug_openffboard_set_up usb_openffboard wheel set_up
pulled unplug_openffboard_ready usb_openffboard wheel ready
pulled unplug_openffboard_enabled usb_openffboard wheel enabled 10
