# Checks on the sources and on what was built of them. Each script shows first that it can fail.
function(hapticd_script_test label name script)
  add_test(NAME ${label}.${name} COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/${label}/${script} ${ARGN})
  set_tests_properties(${label}.${name} PROPERTIES LABELS ${label} SKIP_RETURN_CODE 77 TIMEOUT 120)
endfunction()

hapticd_script_test(lint includes includes.sh ${PROJECT_SOURCE_DIR})
hapticd_script_test(lint format format.sh ${PROJECT_SOURCE_DIR})
hapticd_script_test(lint shell shell.sh ${PROJECT_SOURCE_DIR})
hapticd_script_test(lint top_level top_level.sh ${PROJECT_SOURCE_DIR})
hapticd_script_test(lint examples examples.sh ${PROJECT_SOURCE_DIR} $<TARGET_FILE:hapticctl>)
if(TARGET fault_tables)
  hapticd_script_test(lint man man.sh ${PROJECT_BINARY_DIR}/systemd/man $<TARGET_FILE:fault_tables>
                      $<TARGET_FILE:hapticd> $<TARGET_FILE:hapticctl>)
endif()
# What is imported depends on optimisation and instrumentation: only a plain Release build is held to the list.
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT HAPTICD_SANITIZE)
  hapticd_script_test(lint symbols symbols.sh $<TARGET_FILE:hapticd_control> ${CMAKE_CXX_COMPILER})
endif()
