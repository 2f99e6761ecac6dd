# Completion of `ilaw` for bash: commands and options as the program's own help lists them, laws, scenes, folders.
_ilaw() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$(ilaw --help 2>/dev/null | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p') --help --version" -- "$word")
    return
  fi
  case $word in
    -*)
      mapfile -t COMPREPLY < <(compgen -W "$(ilaw "$command" --help 2>/dev/null | grep -oE '^  (-h,)?--[a-z-]+' | sed 's/.*--/--/')" -- "$word")
      return ;;
  esac
  case $before in
    --out) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
    --law) mapfile -t COMPREPLY < <(compgen -W "$(_ilaw_laws)" -- "$word"); return ;;
  esac
  case $command in
    describe | check | bench)
      mapfile -t COMPREPLY < <(compgen -W "$(_ilaw_laws)" -- "$word"; compgen -f -X '!*.so' -- "$word"; compgen -d -- "$word") ;;
    plot | view | table) mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    *) mapfile -t COMPREPLY < <(compgen -f -X '!*.json' -- "$word"; compgen -d -- "$word") ;;
  esac
}

_ilaw_laws() { ilaw list 2>/dev/null | awk '!/^search path:/ { print $1 }'; }

complete -o filenames -F _ilaw ilaw
