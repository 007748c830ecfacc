add_executable(lcm_sender lcm_sender.cpp)
slamsensor_include_root(lcm_sender tests)
target_link_libraries(lcm_sender PRIVATE slamsensor_flags slamsensor_firmware)
add_test(NAME peers_lcm COMMAND ${Python3_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/lcm_test.py $<TARGET_FILE:lcm_sender>
                                $<TARGET_FILE:slamsensor> ${PROJECT_SOURCE_DIR})
set_tests_properties(peers_lcm PROPERTIES LABELS fast TIMEOUT 300 SKIP_RETURN_CODE 77)
