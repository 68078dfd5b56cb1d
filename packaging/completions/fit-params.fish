# fish completion of fit-params: folders behind an option, --data FOLDER or --data=FOLDER, and the
# YAML files and folders elsewhere
set -l folders '(__fish_complete_directories (commandline -ct | string replace -r "^--[^=]*=" ""))'
set -l yaml '(__fish_complete_suffix .yaml | string match -r "^.*(?:/|\.ya?ml)\$")'
complete -c fit-params -f -k -a $yaml
complete -c fit-params -s h -l help -d 'print the options and examples'
complete -c fit-params -l version -d 'print the version'
complete -c fit-params -l close-loop -d 'add the effects that the model lacks'
complete -c fit-params -l profile -d 'likelihood profiles, of all or of =NAME,NAME'
complete -c fit-params -l suggest-experiment -d 'say which motion to record next'
complete -c fit-params -l check -d 'say what the recordings can tell, do not fit'
complete -c fit-params -l data -x -a $folders -d 'folder of the recordings'
complete -c fit-params -l from -x -a "(__fish_complete_suffix .yaml)" -d 'begin at the values of an axis'
complete -c fit-params -l output -x -a $folders -d 'folder for the results'
complete -c fit-params -l json -d 'print result.json instead of the table'
complete -c fit-params -l quiet -d 'print nothing but errors'
complete -c fit-params -l threads -x -d 'number of threads'
complete -c fit-params -l seed -x -d 'seed of the random starts'
complete -c fit-params -l starts -x -d 'number of starts'
