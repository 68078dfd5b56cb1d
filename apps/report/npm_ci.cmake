# cmake -D NPM= -D SOURCE= -D DIRECTORY= -D STAMP= -D OPTIONS= -P npm_ci.cmake
# Installs what SOURCE/package-lock.json names into DIRECTORY, and nothing into the source tree.
file(MAKE_DIRECTORY ${DIRECTORY})
foreach(file package.json package-lock.json .npmrc)
  file(COPY_FILE ${SOURCE}/${file} ${DIRECTORY}/${file})
endforeach()
execute_process(
  COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund --prefer-offline ${OPTIONS}
  WORKING_DIRECTORY ${DIRECTORY} RESULT_VARIABLE failed OUTPUT_VARIABLE log ERROR_VARIABLE log)
if(failed)
  message(FATAL_ERROR "npm could not install the packages of apps/report:\n${log}\n"
    "Without a network, configure with -DAXISFIT_INTERACTIVE_REPORT=OFF: the charts of "
    "report.html are still pictures then.")
endif()
file(TOUCH ${STAMP})
