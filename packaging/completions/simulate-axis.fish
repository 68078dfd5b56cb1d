# fish completion of simulate-axis: signals behind --signals, which takes several, and the YAML files
# and folders elsewhere
set -l signals 'position velocity acceleration tachometer motor_current V_c V_m drive_force'
set -l yaml '(__fish_complete_suffix .yaml | string match -r "^.*(?:/|\.ya?ml)\$")'
complete -c simulate-axis -f -k -a $yaml
complete -c simulate-axis -s h -l help -d 'print the options and examples'
complete -c simulate-axis -s V -l version -d 'print the version'
complete -c simulate-axis -s o -l output -r -F -d 'CSV file'
complete -c simulate-axis -l set -x -d 'change a quantity: NAME=VALUE'
complete -c simulate-axis -l signals -x -a $signals -d 'signals to record'
complete -c simulate-axis -n 'contains -- --signals (commandline -opc)' -a $signals
complete -c simulate-axis -l rate -x -d 'samples per second'
complete -c simulate-axis -l seed -x -d 'seed of the noise'
complete -c simulate-axis -l band -d '95 % bands of a fitted axis'
complete -c simulate-axis -l exact -d 'no noise, no encoder quantisation, all digits'
