complete -c simulate-axis -s h -l help -d 'print the options and examples'
complete -c simulate-axis -l version -d 'print the version'
complete -c simulate-axis -s o -l output -r -d 'CSV file'
complete -c simulate-axis -l set -x -d 'change a quantity: NAME=VALUE'
complete -c simulate-axis -l signals -x -d 'signals to record' \
    -a 'position velocity acceleration tachometer motor_current V_c V_m drive_force'
complete -c simulate-axis -l rate -x -d 'samples per second'
complete -c simulate-axis -l seed -x -d 'seed of the noise'
complete -c simulate-axis -l exact -d 'no noise, encoder not quantised, all digits'
