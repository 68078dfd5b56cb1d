# fish completion of simulate-fleet: folders
set -l folders '(__fish_complete_directories (commandline -ct))'
complete -c simulate-fleet -f -k -a $folders
complete -c simulate-fleet -s h -l help -d 'print the options and examples'
complete -c simulate-fleet -s V -l version -d 'print the version'
complete -c simulate-fleet -l axes -x -d 'number of axes'
complete -c simulate-fleet -l nights -x -d 'number of nights'
complete -c simulate-fleet -l seed -x -d 'seed of all that is drawn'
complete -c simulate-fleet -l worn -x -d 'share of the axes that wear'
complete -c simulate-fleet -l missing -x -d 'share of nights without a recording'
complete -c simulate-fleet -l wrong -x -d 'share of damaged recordings'
complete -c simulate-fleet -l threads -x -d 'number of threads'
