# What all FMUs of a version of the standard have, as an archive that is the same to the byte
# whenever it is made: -DVERSION -DLIBRARY -DPROJECT -DSOURCES -DARCHIVE
set(platform_2 linux64)
set(platform_3 x86_64-linux)
set(folder ${ARCHIVE}.files)
file(REMOVE_RECURSE ${folder})
file(COPY ${LIBRARY} DESTINATION ${folder}/binaries/${platform_${VERSION}})
file(COPY ${PROJECT}/LICENSE DESTINATION ${folder}/documentation/licenses)
foreach(source ${SOURCES})
  get_filename_component(place ${source} DIRECTORY)
  file(COPY ${PROJECT}/${source} DESTINATION ${folder}/sources/${place})
endforeach()
file(GLOB_RECURSE files RELATIVE ${folder} ${folder}/*)  # in order
execute_process(
  COMMAND ${CMAKE_COMMAND} -E tar cf ${ARCHIVE} --format=zip --mtime=1980-01-02 ${files}
  WORKING_DIRECTORY ${folder} COMMAND_ERROR_IS_FATAL ANY)
file(REMOVE_RECURSE ${folder})
