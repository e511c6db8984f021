# The real beltpickd with lines of this PC: its configuration judged, its self-test, its start-up errors, the lines it
# holds while it runs, and what is left of them after a crash.
# modules: gpio-sim
# targets: beltpickd
# programs: gpioinfo gpiomon
# limit_s: 180
set -u
fail() {
  echo "FAILED: $*"
  exit 1
}
# expect_text WHAT FILE TEXT...: each text stands in the file.
expect_text() {
  what=$1 file=$2
  shift 2
  for text in "$@"; do
    grep -qF "$text" "$file" || { cat "$file"; fail "$what: expected '$text'"; }
  done
}

chip=/sys/kernel/config/gpio-sim/cell
mkdir -p $chip/bank0/line7
echo 8 >$chip/bank0/num_lines
echo cell >$chip/bank0/label
echo STROBE >$chip/bank0/line7/name
echo 1 >$chip/live
name=$(cat $chip/bank0/chip_name)
lines=/sys/devices/platform/$(cat $chip/dev_name)/$name
trap "echo 0 >$chip/live" EXIT
pull() { echo "pull-$2" >"$lines/sim_gpio$1/pull"; }
level() { cat "$lines/sim_gpio$1/value"; }
pull 0 up # the belt stands
pull 1 up # the emergency stop is released: closed, active-low

# config KEY=VALUE...: of [lines], beside the good ones.
config() {
  cat <<END
[trigger]
source = "lines"
[lines]
chip = "cell"
belt_stopped = "0"
emergency_stop = "1 active-low"
belt_may_move = "${belt_may_move:-2}"
camera = "${camera:-3}"
projector = "$name:4"
busy = "5"
fault = "6"
strobe = "STROBE"
[plc]
port = 1502
[service]
state = "state"
END
}

config >good.toml
camera="3 upside-down" config >wrong.toml
beltpickd --config wrong.toml --check >log 2>&1 && fail "--check took a line's text that means nothing"
expect_text "--check of a wrong text" log "lines.camera" "upside-down"
beltpickd --config good.toml --check >log 2>&1 && fail "--check took a cell without calibration"
expect_text "--check of good lines judges what comes after them" log "NO_CALIBRATION"
echo "--check: as expected"

beltpickd --config good.toml --self-test >log 2>&1
expect_text "self-test" log "belt_stopped: line 0 of cell, input, active" "emergency_stop: line 1 of cell, input, inactive" \
  "strobe: line STROBE of cell, input, inactive" "libgpiod" "belt stopped, emergency stop released"
grep "GPIO lines" log
pull 1 down
beltpickd --config good.toml --self-test >log 2>&1
expect_text "self-test with the emergency stop pressed" log "emergency stop pressed"
pull 1 up
echo "--self-test: as expected"

camera=77 config >missing.toml
beltpickd --config missing.toml >log 2>&1 && fail "it started without a line"
expect_text "missing line" log "LINE_NOT_FOUND" "lines.camera" "'77'" "0 to 7"
gpiomon "$name" 2 >/dev/null &
holder=$!
sleep 0.5
beltpickd --config good.toml >log 2>&1 && fail "it started with a line that another program holds"
expect_text "busy line" log "LINE_IN_USE" "lines.belt_may_move" "held by 'gpiomon'"
beltpickd --config good.toml --self-test >log 2>&1 && fail "the self-test is good with a busy line"
expect_text "self-test with a busy line" log "held by 'gpiomon'"
kill $holder
wait $holder
tail -n 1 log
echo "start-up errors: as expected"

start() {
  : >log # of the run before
  beltpickd --config good.toml 2>log &
  daemon=$!
  for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
    grep -q "PLC: Modbus" log && return
    sleep 0.5
  done
  cat log
  fail "it does not start"
}
start
gpioinfo "$name" >held
expect_text "lines held" held '"beltpick belt_stopped"' '"beltpick belt_may_move"' '"beltpick strobe"'
[ "$(level 2)$(level 3)$(level 4)" = 000 ] || fail "an output is active though nothing was started"
beltpickd --config good.toml --self-test >word 2>&1
expect_text "self-test beside the running one" word "the running beltpickd has it"
kill -9 $daemon
wait $daemon
gpioinfo "$name" >held
grep -q beltpick held && fail "a line is still held after a crash"
beltpickd --config good.toml --outputs-off || fail "--outputs-off"
[ "$(level 2)" = 0 ] || fail "the belt may move after a crash"
start
kill -TERM $daemon
wait $daemon || fail "no clean stop: $(cat log)"
expect_text "start" log "by libgpiod" "belt_may_move: line 2 of cell, output, inactive"
echo "held, crashed, stopped: as expected"
