# gpsd, and python3-nmea2 where Debian's Python has it, as readers of the NMEA output.
find_program(SLAMSENSOR_DEBIAN_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH REQUIRED)
add_executable(nmea_rig ${CMAKE_CURRENT_LIST_DIR}/nmea_rig.cpp)
slamsensor_include_root(nmea_rig tests)
target_link_libraries(nmea_rig PRIVATE slamsensor_flags slamsensor_firmware)
add_test(NAME peers_gpsd COMMAND ${SLAMSENSOR_DEBIAN_PYTHON} -B ${CMAKE_CURRENT_LIST_DIR}/nmea_gpsd_test.py
                                 $<TARGET_FILE:nmea_rig>)
set_tests_properties(peers_gpsd PROPERTIES LABELS fast TIMEOUT 180 SKIP_RETURN_CODE 77)
