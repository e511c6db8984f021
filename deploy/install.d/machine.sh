# Steps of deploy/install that touch the machine itself: packages, account, kernel settings, service manager. In a tree
# they are left to its first boot, which does them by the files placed there.

has() { command -v "$1" >/dev/null 2>&1; }
systemd_runs() { [ -z "$tree" ] && [ -d /run/systemd/system ]; }

need_libraries() {
  if [ -n "$tree" ]; then
    say "the tree needs the Debian packages of 'deploy/setup run'"
    return
  fi
  missing=$(ldd "$bin/beltpick" "$bin/beltpickd" | sed -n 's/^[[:space:]]*\([^ ]*\) => not found.*/\1/p' | sort -u | paste -sd ' ')
  if [ -z "$missing" ]; then
    say "all shared libraries are there"
  else
    act "shared libraries are missing ($missing): installing Debian packages" "$source_tree/deploy/setup" run
  fi
}

make_account() {
  if [ -n "$tree" ]; then
    say "the account 'beltpick' is made at the tree's first boot"
  elif getent passwd beltpick >/dev/null; then
    say "the account 'beltpick' is there"
  elif has systemd-sysusers; then
    act "account 'beltpick': beltpickd runs as it, not as root" systemd-sysusers /usr/lib/sysusers.d/beltpick.conf
  else
    act "account 'beltpick': beltpickd runs as it, not as root" useradd --system --user-group --no-create-home \
      --home-dir "$state" --shell /usr/sbin/nologin --groups dialout,video beltpick
  fi
}

make_state() {
  local owner=(-o beltpick -g beltpick)
  [ -z "$tree" ] || owner=()
  if [ -d "$tree$state" ]; then
    say "$state is there: it is kept"
  else
    act "$state: store, tokens and certificate, for beltpickd only" install -d -m 750 "${owner[@]}" "$tree$state"
  fi
}

enable_at_boot() {
  act "$at_boot: beltpickd starts at boot" put_link "$unit" "$tree$at_boot"
}
put_link() { mkdir -p "$(dirname "$2")" && ln -sfn "$1" "$2"; }

apply_to_machine() {
  [ -z "$tree" ] || return 0
  raise_receive_buffer
  if has udevadm && [ -d /run/udev ]; then
    act "udev: name trigger box and projector if they are plugged in" reload_udev
  fi
  if systemd_runs; then
    act "systemd: read the unit" systemctl daemon-reload
    start_service
    say "next: 'beltpickd --self-test --config $configuration', then 'beltpick enrol --to localhost --token $state/one_time_token'"
  else
    tell_foreground
  fi
}

# Never lowers what an administrator has raised.
raise_receive_buffer() {
  local wanted now
  wanted=$(sed -n 's/^net.core.rmem_max = //p' "$source_tree/deploy/systemd/sysctl.conf")
  now=$(cat /proc/sys/net/core/rmem_max 2>/dev/null || echo 0)
  [ "$now" -lt "$wanted" ] || return 0
  if $dry || [ -w /proc/sys/net/core/rmem_max ]; then
    act "net.core.rmem_max: $now -> $wanted bytes, room for whole frames" set_receive_buffer "$wanted"
  fi
}
# A container may show the setting and yet refuse it: the file in sysctl.d holds from the next boot of the host on.
set_receive_buffer() {
  { echo "$1" >/proc/sys/net/core/rmem_max; } 2>/dev/null || say "the kernel does not take it now: it will at the next boot"
}
reload_udev() {
  udevadm control --reload && udevadm trigger --subsystem-match=tty --subsystem-match=hidraw --subsystem-match=gpio
}

start_service() {
  if $first_install; then
    act "systemd: start beltpickd" systemctl start beltpickd
  else
    act "systemd: restart beltpickd if it runs, so that the new version counts" systemctl try-restart beltpickd
  fi
}

tell_foreground() {
  say "systemd is not in charge here, so nothing was started. In the foreground, as its user, with port 502 allowed:"
  say "  setpriv --reuid=beltpick --regid=beltpick --init-groups --inh-caps=+net_bind_service" \
    "--ambient-caps=+net_bind_service /usr/sbin/beltpickd --config $configuration"
}

stop_service() {
  if systemd_runs && [ -e "$unit" ]; then
    act "systemd: stop beltpickd, and not at boot any more" systemctl disable --now beltpickd
  elif [ -z "$tree" ] && pgrep -x beltpickd >/dev/null 2>&1; then
    say "a beltpickd runs that systemd does not know: end it yourself"
  fi
}

forget_on_machine() {
  if systemd_runs; then act "systemd: forget the unit" systemctl daemon-reload; fi
  if [ -z "$tree" ] && has udevadm && [ -d /run/udev ]; then act "udev: forget the rule" udevadm control --reload; fi
  [ -n "$tree" ] || say "net.core.rmem_max keeps its value until the next boot; Debian packages stay"
}

remove_account() {
  if [ -z "$tree" ] && getent passwd beltpick >/dev/null; then
    act "account 'beltpick': removed" userdel beltpick
    if getent group beltpick >/dev/null; then act "group 'beltpick': removed" groupdel beltpick; fi
  fi
}
