# The library for developers, component dev: libaxisfit.a, the public headers in one folder
# axisfit/, and what find_package and pkg-config read.

# Public are axisfit.h and whatever it includes. Their includes get the prefix axisfit/.
set(include ${CMAKE_CURRENT_BINARY_DIR}/include/axisfit)
file(REMOVE_RECURSE ${include})
set(headers packaging/axisfit.h)
set(public "")
while(headers)
  list(POP_FRONT headers header)
  list(APPEND public ${header})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${header})
  file(READ ${PROJECT_SOURCE_DIR}/${header} text)
  string(REGEX MATCHALL "#include \"[^\"]+\"" includes "${text}")
  string(REPLACE "#include \"" "#include \"axisfit/" text "${text}")
  string(REPLACE "packaging/" "" name ${header})
  file(WRITE ${include}/${name} "${text}")
  list(TRANSFORM includes REPLACE "#include \"(.*)\"" "\\1")
  list(APPEND headers ${includes})
  list(REMOVE_DUPLICATES headers)
  list(REMOVE_ITEM headers ${public})
endwhile()
install(DIRECTORY ${include} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev)
install(TARGETS axisfit DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
install(FILES ${PROJECT_SOURCE_DIR}/examples/fit_in_memory.cpp
              ${PROJECT_SOURCE_DIR}/examples/CMakeLists.txt
        DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT dev)

# As they are linked, and the packages that have them.
set(AXISFIT_LINK_LIBRARIES
  ceres glog fmt yaml-cpp matio udunits2 minizip pugixml lz4 zstd z)
string(REGEX REPLACE "([^;]+);?" "-l\\1 " AXISFIT_PC_LIBRARIES "${AXISFIT_LINK_LIBRARIES}")
string(STRIP "${AXISFIT_PC_LIBRARIES}" AXISFIT_PC_LIBRARIES)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libceres-dev, libeigen3-dev, libgoogle-glog-dev, \
libyaml-cpp-dev, libfmt-dev, libmatio-dev, libudunits2-dev, libminizip-dev, libpugixml-dev, \
liblz4-dev, libzstd-dev, zlib1g-dev")

include(CMakePackageConfigHelpers)
set(config ${CMAKE_INSTALL_LIBDIR}/cmake/axisfit)
configure_package_config_file(axisfitConfig.cmake.in axisfitConfig.cmake
  INSTALL_DESTINATION ${config} PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_INCLUDEDIR)
write_basic_package_version_file(axisfitConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/axisfitConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/axisfitConfigVersion.cmake
        DESTINATION ${config} COMPONENT dev)
file(RELATIVE_PATH AXISFIT_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" AXISFIT_PC_PREFIX "${AXISFIT_PC_PREFIX}")
configure_file(axisfit.pc.in axisfit.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/axisfit.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
