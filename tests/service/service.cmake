# Checks on what makes hapticd a service: unit, user, udev rule, installation. hapticd_script_test: lint/lint.cmake.
set(service_build ${PROJECT_BINARY_DIR}/systemd)
hapticd_script_test(service unit unit.sh ${service_build}/hapticd.service $<TARGET_FILE:hapticd> ${service_build}/man)
hapticd_script_test(service sysusers sysusers.sh ${PROJECT_SOURCE_DIR}/systemd/hapticd.sysusers)
hapticd_script_test(service udev udev.sh ${PROJECT_SOURCE_DIR}/systemd/60-hapticd.rules)
hapticd_script_test(service install install.sh ${PROJECT_BINARY_DIR})
hapticd_script_test(service rights rights.sh $<TARGET_FILE:hapticd> ${PROJECT_SOURCE_DIR}/config/examples/wall.yaml)
