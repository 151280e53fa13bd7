# One deliberate fault in each codec, a sign, a scale, a byte order, has to turn the seam suite red: the emulated drives
# must not share it. The suite is linked anew with the faulty file in place of the sound one.
function(hapticd_faulty_codec name file tests right wrong)
  file(READ ${PROJECT_SOURCE_DIR}/drivers/${file} sound)
  string(REPLACE "${right}" "${wrong}" faulty "${sound}")
  if(faulty STREQUAL sound)
    message(FATAL_ERROR "drivers/${file} has no \"${right}\" to be made wrong for ${name}")
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/drivers/${file})
  file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp CONTENT "${faulty}")
  add_executable(${name} ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp $<TARGET_OBJECTS:test_seam>)
  target_link_libraries(${name} PRIVATE test_support hapticd_config hapticd_can hapticd_usb_devices GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${name} --gtest_filter=${tests})
  # A crash would not do: its tests have to say no.
  set_tests_properties(${name} PROPERTIES PASS_REGULAR_EXPRESSION "[0-9]+ FAILED TEST" LABELS unit TIMEOUT 300)
endfunction()

hapticd_faulty_codec(faulty_odrive_sign can/odrive_codec.cpp *CanSeam.*
  "put_float(frame, 0, torque_Nm)" "put_float(frame, 0, -torque_Nm)")
hapticd_faulty_codec(faulty_moteus_scale can/moteus_codec.cpp *CanSeam.*
  "put(*frame, kTorqueAt, static_cast<float>(torque_Nm))"
  "put(*frame, kTorqueAt, static_cast<float>(1.1 * torque_Nm))")
hapticd_faulty_codec(faulty_cia402_byte_order can/cia402_codec.cpp *CanSeam.*
  "put(frame, 2, torque_raw)"
  "put(frame, 2, static_cast<std::int16_t>(__builtin_bswap16(static_cast<std::uint16_t>(torque_raw))))")
hapticd_faulty_codec(faulty_odrive_position can/odrive_codec.cpp *CanSeam.*
  "const float a = get<float>(bytes, 0)" "const float a = -get<float>(bytes, 0)")
hapticd_faulty_codec(faulty_moteus_position can/moteus_reply.cpp *CanSeam.*
  "reply.position = value" "reply.position = 0.9 * value")
hapticd_faulty_codec(faulty_cia402_position can/cia402_codec.cpp *CanSeam.*
  "get<std::int32_t>(b, 2)" "-get<std::int32_t>(b, 2)")
hapticd_faulty_codec(faulty_falcon_torque usb/falcon_codec.cpp *UsbSeam.*falcon
  "put_nibbles(encoded.packet, 1 + 4 * leg, encoded.motor_counts[leg])"
  "put_nibbles(encoded.packet, 1 + 4 * leg, static_cast<std::int16_t>(-encoded.motor_counts[leg]))")
hapticd_faulty_codec(faulty_falcon_position usb/falcon_codec.cpp *UsbSeam.*falcon
  "nibbles_at(packet + 1 + 4 * leg)" "static_cast<std::int16_t>(-nibbles_at(packet + 1 + 4 * leg))")
hapticd_faulty_codec(faulty_report_effort hid/report_map.cpp *UsbSeam.*hid_report
  "(clipped - field.offset) / field.scale" "1.5 * (clipped - field.offset) / field.scale")
hapticd_faulty_codec(faulty_report_position hid/report_map.cpp *UsbSeam.*hid_report
  "return static_cast<std::int64_t>(negative" "return -static_cast<std::int64_t>(negative")
hapticd_faulty_codec(faulty_openffboard_torque hid/openffboard_codec.cpp *UsbSeam.*openffboard
  "put(std::span<std::uint8_t>(encoded.report), 2, encoded.magnitude)"
  "put(std::span<std::uint8_t>(encoded.report), 2, static_cast<std::int16_t>(-encoded.magnitude))")
