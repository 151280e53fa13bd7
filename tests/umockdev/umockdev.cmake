# The real libusb against a kernel that umockdev plays: every program of these tests is run by its wrapper.
pkg_check_modules(UMOCKDEV IMPORTED_TARGET umockdev-1.0)
find_program(UMOCKDEV_WRAPPER umockdev-wrapper)
if(UMOCKDEV_FOUND AND UMOCKDEV_WRAPPER)
  file(GLOB umockdev_sources CONFIGURE_DEPENDS umockdev/*.cpp)
  add_executable(test_umockdev ${umockdev_sources})
  target_link_libraries(test_umockdev PRIVATE hapticd_usb PkgConfig::UMOCKDEV GTest::gmock GTest::gtest_main)
  set_target_properties(test_umockdev PROPERTIES CROSSCOMPILING_EMULATOR ${UMOCKDEV_WRAPPER})
  gtest_discover_tests(test_umockdev DISCOVERY_TIMEOUT 60 PROPERTIES LABELS unit TIMEOUT 300)
else()
  add_test(NAME umockdev COMMAND ${CMAKE_COMMAND} -E echo
           "SKIPPED: libusb is not tested: umockdev or libumockdev-dev is not installed")
  set_tests_properties(umockdev PROPERTIES LABELS unit SKIP_REGULAR_EXPRESSION SKIPPED)
endif()
