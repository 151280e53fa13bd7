# One deliberate fault in each codec, a sign, a scale, a byte order, has to turn the seam suite red: the emulated drives
# must not share it. The suite is linked anew with the faulty file in place of the sound one.
function(hapticd_faulty_codec name file right wrong)
  file(READ ${PROJECT_SOURCE_DIR}/drivers/can/${file} sound)
  string(REPLACE "${right}" "${wrong}" faulty "${sound}")
  if(faulty STREQUAL sound)
    message(FATAL_ERROR "drivers/can/${file} has no \"${right}\" to be made wrong for ${name}")
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/drivers/can/${file})
  file(GENERATE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp CONTENT "${faulty}")
  add_executable(${name} ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp $<TARGET_OBJECTS:test_seam>)
  target_link_libraries(${name} PRIVATE test_support hapticd_config hapticd_can GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${name} --gtest_filter=*CanSeam.*)
  # A crash would not do: its tests have to say no.
  set_tests_properties(${name} PROPERTIES PASS_REGULAR_EXPRESSION "[0-9]+ FAILED TEST" LABELS unit TIMEOUT 300)
endfunction()

hapticd_faulty_codec(faulty_odrive_sign odrive_codec.cpp
  "put_float(frame, 0, torque_Nm)" "put_float(frame, 0, -torque_Nm)")
hapticd_faulty_codec(faulty_moteus_scale moteus_codec.cpp
  "put(*frame, kTorqueAt, static_cast<float>(torque_Nm))"
  "put(*frame, kTorqueAt, static_cast<float>(1.1 * torque_Nm))")
hapticd_faulty_codec(faulty_cia402_byte_order cia402_codec.cpp
  "put(frame, 2, torque_raw)"
  "put(frame, 2, static_cast<std::int16_t>(__builtin_bswap16(static_cast<std::uint16_t>(torque_raw))))")
hapticd_faulty_codec(faulty_odrive_position odrive_codec.cpp
  "const float a = get<float>(bytes, 0)" "const float a = -get<float>(bytes, 0)")
hapticd_faulty_codec(faulty_moteus_position moteus_reply.cpp
  "reply.position = value" "reply.position = 0.9 * value")
hapticd_faulty_codec(faulty_cia402_position cia402_codec.cpp
  "get<std::int32_t>(b, 2)" "-get<std::int32_t>(b, 2)")
