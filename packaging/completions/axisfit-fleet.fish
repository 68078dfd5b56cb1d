# fish completion of axisfit-fleet: its commands, then fleet files or folders of plans
set -l folders '(__fish_complete_directories (commandline -ct | string replace -r "^--[^=]*=" ""))'
set -l yaml '(__fish_complete_suffix .yaml | string match -r "^.*(?:/|\.ya?ml)\$")'
set -l commands plan work merge submit report table job
set -l none "not __fish_seen_subcommand_from $commands"
complete -c axisfit-fleet -f
complete -c axisfit-fleet -n $none -a "$commands"
complete -c axisfit-fleet -n $none -s V -l version -d 'print the version'
complete -c axisfit-fleet -s h -l help -d 'print the options and examples'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from plan report table job' -k -a $yaml
complete -c axisfit-fleet -n '__fish_seen_subcommand_from work merge submit' -k -a $folders
complete -c axisfit-fleet -n '__fish_seen_subcommand_from plan' -l plan -x -a $folders -d 'folder of the plan'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from plan' -l retry -x -a failed -d 'plan what has failed, too'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from work' -l shard -x -d 'every N-th item from I on, I/N'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from work' -l threads -x -d 'items at a time'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from submit' -l tasks -x -d 'tasks of the array'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from submit' -l minutes -x -d 'that a task may take'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from submit' -l memory -x -d 'MB for a task'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from submit' -l partition -x -d 'of the cluster'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from report' -l json -d 'as JSON'
complete -c axisfit-fleet -n '__fish_seen_subcommand_from report' -l page -r -d 'a page for a browser as well'
