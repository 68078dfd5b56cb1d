# fish completion of axisfit-export: folders behind --output and --data, and the YAML files and folders
# elsewhere
set -l folders '(__fish_complete_directories (commandline -ct | string replace -r "^--[^=]*=" ""))'
set -l yaml '(__fish_complete_suffix .yaml | string match -r "^.*(?:/|\.ya?ml)\$")'
complete -c axisfit-export -f -k -a $yaml
complete -c axisfit-export -s h -l help -d 'print the options and examples'
complete -c axisfit-export -s V -l version -d 'print the version'
complete -c axisfit-export -l to -x -a 'fmu2 fmu3 c mjcf urdf matlab frc' -d 'what to write'
complete -c axisfit-export -s o -l output -x -a $folders -d 'folder of the files'
complete -c axisfit-export -l job -x -a $yaml -d 'say what is lost by the recordings of a job'
complete -c axisfit-export -l data -x -a $folders -d 'folder of the recordings'
