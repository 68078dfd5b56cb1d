# cmake -D NPM= -D DIRECTORY= -P packages.cmake
# Installs what package-lock.json names into DIRECTORY/node_modules, unless it is there.
set(stamp ${DIRECTORY}/packages.stamp)
if(EXISTS ${stamp} AND NOT ${CMAKE_CURRENT_LIST_DIR}/package-lock.json IS_NEWER_THAN ${stamp})
  return()
endif()
file(MAKE_DIRECTORY ${DIRECTORY})
foreach(file package.json package-lock.json .npmrc)
  file(COPY_FILE ${CMAKE_CURRENT_LIST_DIR}/${file} ${DIRECTORY}/${file})
endforeach()
execute_process(
  COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline
  WORKING_DIRECTORY ${DIRECTORY} RESULT_VARIABLE failed OUTPUT_VARIABLE log ERROR_VARIABLE log)
if(failed)
  message(FATAL_ERROR "npm could not install the packages of tests/report:\n${log}")
endif()
file(TOUCH ${stamp})
