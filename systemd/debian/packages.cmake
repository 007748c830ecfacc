# Debian packages: cmake -DCMAKE_INSTALL_PREFIX=/usr, build, then `cpack -G DEB` (tests/system/packages does it all).
#   slamsensor            the daemon, its units, rules, configuration and the profiles of real heads
#   slamsensor-tools      the command slamsensor, worlds, profiles of experiments
#   slamsensor-emulator   the emulated head as a service
#   slamsensor-dev        types of the LCM messages, and examples of readers
set(CPACK_PACKAGE_NAME slamsensor)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
# Who builds the packages answers for them, and is named as Debian's tools are told (debchange(1)): DEBFULLNAME and
# DEBEMAIL in the environment. Without them the address is one that cannot be (RFC 2606).
if(NOT "$ENV{DEBFULLNAME}" STREQUAL "" AND NOT "$ENV{DEBEMAIL}" STREQUAL "")
  set(CPACK_PACKAGE_CONTACT "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
else()
  set(CPACK_PACKAGE_CONTACT "slamsensor developers <developers@slamsensor.invalid>")
endif()
set(CPACK_COMPONENTS_ALL daemon tools emulator dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_SET_DESTDIR ON) # the configuration lies outside of the prefix
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SECTION non-free/science) # no public licence (copyright)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
endif()

# The first line is the summary; CPack indents the rest.
set(common "It scans with a laser rangefinder on a pan-tilt unit, picks landmarks
out of each scan and finds itself in its own map, without odometry and
without an initial pose. Its fixes are read as those of a GPS receiver:
NMEA 0183 on a serial line or TCP, and LCM.
")
set(CPACK_COMPONENT_DAEMON_DESCRIPTION "SLAM sensor that reads like a GPS receiver
${common}
This package has the daemon slamsensord, its units and rules, and its
configuration.")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "SLAM sensor: control, replay and simulation
${common}
This package has the command slamsensor: control of a running sensor, a
live view, replay of recordings and point clouds, evaluation, simulation.")
set(CPACK_COMPONENT_EMULATOR_DESCRIPTION "SLAM sensor: emulated sensor head as a service
${common}
This package has a service that emulates the devices of a head, and how
the daemon is put on it.")
set(CPACK_COMPONENT_DEV_DESCRIPTION "SLAM sensor: types of its LCM messages
${common}
This package has the types of the messages, for lcm-gen, and examples of
programs that read them.")

set(same "(= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DAEMON_PACKAGE_NAME slamsensor)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME slamsensor-tools)
set(CPACK_DEBIAN_EMULATOR_PACKAGE_NAME slamsensor-emulator)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME slamsensor-dev)
set(CPACK_DEBIAN_DAEMON_PACKAGE_DEPENDS "systemd, udev")
set(CPACK_DEBIAN_DAEMON_PACKAGE_RECOMMENDS "slamsensor-tools ${same}, iproute2")
set(CPACK_DEBIAN_EMULATOR_PACKAGE_DEPENDS "slamsensor ${same}, slamsensor-tools ${same}")
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS python3) # of an example
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS liblcm-bin)
set(CPACK_DEBIAN_DEV_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_EMULATOR_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_EMULATOR_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION non-free/libdevel)

# Maintainer scripts and conffiles; documents that every package must have.
set(scripts ${CMAKE_CURRENT_LIST_DIR})
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_EXTRA
  ${scripts}/conffiles ${scripts}/postinst ${scripts}/prerm ${scripts}/postrm)
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_STRICT_PERMISSION ON)
configure_file(${CMAKE_CURRENT_LIST_DIR}/changelog.in ${CMAKE_CURRENT_BINARY_DIR}/changelog @ONLY)
execute_process(COMMAND gzip -9nc ${CMAKE_CURRENT_BINARY_DIR}/changelog
  OUTPUT_FILE ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
foreach(package IN ITEMS daemon:slamsensor tools:slamsensor-tools emulator:slamsensor-emulator dev:slamsensor-dev)
  string(REPLACE ":" ";" package ${package})
  list(GET package 0 component)
  list(GET package 1 name)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endforeach()
include(CPack)
