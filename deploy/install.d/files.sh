# Steps of deploy/install that put files in place and take them away, on this machine or in a tree.

unit=/usr/lib/systemd/system/beltpickd.service
at_boot=/etc/systemd/system/multi-user.target.wants/beltpickd.service
configuration=/etc/beltpick/beltpickd.toml
pristine=/usr/share/beltpick/beltpickd.toml
manifest=/usr/share/beltpick/installed-files
firmware_target=/usr/share/beltpick/firmware
state=/var/lib/beltpick

# Where a Debian package would put them: target, mode, source, why. A daemon belongs into sbin.
files=(
  "/usr/bin/beltpick|755|@bin/beltpick|the engineer's command line"
  "/usr/sbin/beltpickd|755|@bin/beltpickd|the appliance"
  "$unit|644|deploy/systemd/beltpickd.service|starts beltpickd at boot, watches and confines it"
  "/usr/lib/sysusers.d/beltpick.conf|644|deploy/systemd/sysusers.conf|the account it runs as, without rights of its own"
  "/usr/lib/tmpfiles.d/beltpick.conf|644|deploy/systemd/tmpfiles.conf|its state folder, open to nobody else"
  "/usr/lib/sysctl.d/60-beltpick.conf|644|deploy/systemd/sysctl.conf|lets the camera's socket hold whole frames"
  "/usr/lib/udev/rules.d/60-beltpick.rules|644|deploy/udev/60-beltpick.rules|trigger box and projector as /dev/beltpick-trigger and /dev/beltpick-projector"
  "/usr/share/doc/beltpick/copyright|644|LICENSE|the licence"
)

say() { echo "install: $*"; }
refuse() {
  echo "deploy/install: $*" >&2
  exit 2
}
# act WHAT COMMAND...: does it, or tells that it would.
act() {
  local what=$1
  shift
  if $dry; then
    say "would: $what"
    return
  fi
  say "$what"
  "$@" || refuse "$what: failed ('$*'); mend what it says and run deploy/install again"
}

need_programs() {
  local name
  for name in beltpick beltpickd; do
    [ -x "$bin/$name" ] || refuse "$bin/$name is not there: build it first (cmake --preset release && cmake --build \
--preset release), or name its folder with --bin"
  done
}

# What 'beltpick flash' gives the trigger box. It needs another compiler: who has none installs without.
find_firmware() {
  local name found=()
  for name in trigger_atmega2560 trigger_atmega328p boot_atmega2560 boot_atmega328p; do
    [ ! -f "$firmware/$name.hex" ] ||
      found+=("$firmware_target/$name.hex|644|@firmware/$name.hex|for the trigger box, by 'beltpick flash'")
  done
  files+=("${found[@]}")
  [ ${#found[@]} -gt 0 ] || say "no firmware for the trigger box in $firmware: none is put in place ('cmake --preset fw \
&& cmake --build --preset fw' makes it)"
}

# place TARGET MODE SOURCE WHY: whole or not at all, and also over a program that runs.
place() {
  local target=$tree$1 mode=$2 from=$3 why=$4
  $dry || rm -f "$target.beltpick-new"  # of an interrupted run
  if [ -f "$target" ] && cmp -s "$from" "$target" && [ "$(stat -c %a "$target")" = "$mode" ]; then
    say "$1 is up to date ($why)"
    return
  fi
  act "$1: $why" put "$target" "$mode" "$from"
}
put() {
  mkdir -p "$(dirname "$1")" && install -m "$2" "$3" "$1.beltpick-new" && mv -f "$1.beltpick-new" "$1"
}

place_files() {
  local entry target mode from why
  for entry in "${files[@]}"; do
    IFS='|' read -r target mode from why <<<"$entry"
    case $from in
      @bin/*) from=$bin/${from#@bin/} ;;
      @firmware/*) from=$firmware/${from#@firmware/} ;;
      *) from=$source_tree/$from ;;
    esac
    place "$target" "$mode" "$from" "$why"
  done
  drop_leftovers
}

# Last of all: its absence tells an interrupted installation, whose service is still to be started.
place_manifest() {
  { printf '%s\n' "${files[@]%%|*}"; printf '%s\n' "$pristine" "$manifest"; } >"$scratch/manifest"
  place "$manifest" 644 "$scratch/manifest" "what --uninstall takes away"
}

# Files of an earlier version that this one has no more.
drop_leftovers() {
  local path
  [ -f "$tree$manifest" ] || return 0
  while read -r path; do
    case " ${files[*]%%|*} $pristine $manifest " in
      *" $path "*) ;;
      *) [ ! -e "$tree$path" ] || act "$path: an earlier version's, no longer needed: removed" rm -f "$tree$path" ;;
    esac
  done <"$tree$manifest"
}

# The appliance's defaults, with the places of an installed one. A key that is not found is a bug of this script.
installed_defaults() {
  local setting key
  "$bin/beltpickd" --print-config >"$scratch/defaults.toml" ||
    refuse "$bin/beltpickd does not run here: build it on this machine, or see its message above"
  for setting in "state = \"$state\"" 'tty = "/dev/beltpick-trigger"'; do
    key=${setting%% =*}
    [ "$(grep -c "^$key = " "$scratch/defaults.toml")" = 1 ] || refuse "--print-config: expected one key '$key'"
    sed -i "s|^$key = \"[^\"]*\" *#|$(printf '%-36s' "$setting")#|" "$scratch/defaults.toml"
  done
}

# An edited configuration is never overwritten.
place_configuration() {
  local target=$tree$configuration
  if $dry && [ -n "$missing" ]; then
    say "would: $configuration: the configuration, which beltpickd tells once its libraries are there"
    return
  fi
  installed_defaults
  if [ -f "$target" ] && ! cmp -s "$target" "$scratch/defaults.toml" && ! cmp -s "$target" "$tree$pristine"; then
    say "$configuration was edited: it stays as it is"
    place "$configuration.new" 644 "$scratch/defaults.toml" "this version's defaults, to compare"
  else
    place "$configuration" 644 "$scratch/defaults.toml" "the configuration: every key with its meaning"
    [ ! -e "$target.new" ] || act "$configuration.new: no longer needed: removed" rm -f "$target.new"
  fi
  place "$pristine" 644 "$scratch/defaults.toml" "the defaults, to tell an edited configuration by"
}

remove() {
  if [ -e "$tree$1" ] || [ -L "$tree$1" ]; then act "$1: removed" rm -f "$tree$1"; fi
}

# Before the pristine copy, which tells whether it was edited, goes with the other files.
remove_configuration() {
  remove "$configuration.new"
  if [ -f "$tree$configuration" ]; then
    if [ "$job" = purge ] || cmp -s "$tree$configuration" "$tree$pristine"; then
      remove "$configuration"
    else
      say "$configuration was edited: it is kept (--purge takes it)"
    fi
  fi
  remove_folder /etc/beltpick
}

remove_files() {
  local path known=("${files[@]%%|*}")
  [ ! -f "$tree$manifest" ] || mapfile -t -O "${#known[@]}" known <"$tree$manifest"
  remove "$at_boot"
  for path in "${known[@]}"; do
    [ "$path" = "$pristine" ] || [ "$path" = "$manifest" ] || remove "$path"
  done
  remove_configuration
  remove "$pristine"
  remove "$manifest"
  remove_folder "$firmware_target"
  remove_folder /usr/share/beltpick
  remove_folder /usr/share/doc/beltpick
}

# Only when nothing of somebody else's is in it.
remove_folder() {
  [ ! -d "$tree$1" ] || $dry || rmdir "$tree$1" 2>/dev/null || say "$1 is not empty: it is kept"
}

remove_state() {
  [ ! -e "$tree$state" ] || act "$state: calibration, templates, recipes, tokens: removed" rm -rf "$tree$state"
  remove_account
}

tell_what_stays() {
  [ ! -e "$tree$state" ] || say "$state is kept, and the account that owns it (--purge takes them)"
}
