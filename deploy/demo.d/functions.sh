# Steps of deploy/demo, a function each.

say() { echo "demo: $*" >&2; }
refuse() {
  echo "deploy/demo: $*" >&2
  exit 2
}

whole() {
  [[ $2 =~ ^[0-9]{1,9}$ ]] || refuse "$1: expected a whole number, found '$2'"
  echo "$2"
}
decimal() {
  [[ $2 =~ ^[0-9]*\.?[0-9]+$ ]] || refuse "$1: expected a number, found '$2'"
  echo "$2"
}

# Configures where that was not done yet, without the tests' needs, and builds the programs; for the board `emulated`
# also the emulator and the firmware that it runs.
build() {
  local tree=$1 board=$2 log=$1/build/demo.log options=() targets=(beltpick beltpickd)
  mkdir -p "$tree/build"
  : >"$log"
  [ -f "$tree/build/release/CMakeCache.txt" ] || options=(-DBELTPICK_TESTS=OFF)
  configure "$tree" "$log" release "${options[@]}"
  if [ "$board" = emulated ]; then
    targets+=(trigger_emulator)
    configure "$tree" "$log" fw
    compile "$tree/build/fw" "$log" all
  fi
  compile "$tree/build/release" "$log" "${targets[@]}"
}

configure() {
  local tree=$1 log=$2 preset=$3
  (cd "$tree" && cmake --preset "$preset" "${@:4}" >>"$log" 2>&1) && return
  tail -n 30 "$log" >&2
  refuse "configuring failed; see $log"
}

compile() {
  local folder=$1 log=$2
  if [ -t 2 ]; then
    cmake --build "$folder" --target "${@:3}" >&2 || refuse "the build failed"
  elif ! cmake --build "$folder" --target "${@:3}" >>"$log" 2>&1; then
    tail -n 30 "$log" >&2
    refuse "the build failed; see $log"
  fi
}

# What an engineer does once for a cell and a part; kept until the program is built anew.
make_cell() {
  local beltpick=$1 folder=$2
  [ "$folder/complete" -nt "$beltpick" ] && return
  rm -rf "$folder"
  mkdir -p "$folder"
  "$beltpick" simulate --scene bare --sequence standard --out "$folder/rig" --write-parts "$folder" --part knuckle >&2
  mv "$folder/rig/calibration.json" "$folder/rig/cell.json" "$folder/rig/sequence.json" "$folder/"
  rm -rf "$folder/rig"
  "$beltpick" teach "$folder/knuckle.stl" --units mm --grasps "$folder/knuckle.grasps.toml" \
    --out "$folder/knuckle.template" >&2
  cat >"$folder/recipe.json" <<RECIPE
{"format": "beltpick-recipe", "version": 1, "number": 1, "name": "knuckles", "sequence": "sequence.json",
 "exposure_us": 8000, "settle_us": 1000, "period_us": 22000, "templates": ["knuckle.template"]}
RECIPE
  touch "$folder/complete"
}

# The first TCP port from $1 on that nobody listens on.
free_tcp_port() {
  local port=$1
  while grep -qsi "^ *[0-9]*: [0-9A-F]*:$(printf %04X "$port") [0-9A-F:]* 0A" /proc/net/tcp /proc/net/tcp6; do
    port=$((port + 1))
  done
  echo "$port"
}

# The first loopback address whose GigE Vision port, UDP 3956, is free.
free_camera_address() {
  local last=1
  while grep -qsiE "^ *[0-9]+: ($(printf %02X "$last")00007F|00000000):0F74" /proc/net/udp && [ "$last" -lt 250 ]; do
    last=$((last + 1))
  done
  echo "127.0.0.$last"
}

write_config() {
  local file=$1 cell=$2 run=$3 camera=$4 port=$5 frames=$6
  cat >"$file" <<CONFIG
[camera]
id = "$camera"
[trigger]
tty = "$run/trigger"
[model]
calibration = "$cell/calibration.json"
cell = "$cell/cell.json"
recipes = ["$cell/recipe.json"]
[plc]
address = "127.0.0.1"
port = $port
[limits]
frames = 22
decode_bytes = 16
templates = 2
[record]
folder = "$run/pictures"
pictures = true
frames = "$frames"
summary = "$run/summary.json"
CONFIG
}

wait_for_file() {
  local file=$1 process=$2
  for _ in $(seq 600); do
    [ -e "$file" ] && return
    kill -0 "$process" 2>/dev/null || refuse "the virtual cell did not start"
    sleep 0.1
  done
  refuse "the virtual cell did not start within a minute"
}

# Until the belt is empty; neither cell nor appliance must end before.
wait_for_report() {
  local report=$1 world=$2 daemon=$3 log=$4
  until [ -e "$report" ]; do
    kill -0 "$world" 2>/dev/null || refuse "the virtual cell ended before the belt was empty; see $log"
    if ! kill -0 "$daemon" 2>/dev/null; then
      tail -n 20 "$log" >&2
      refuse "beltpickd ended; see $log"
    fi
    sleep 0.2
  done
}

# Ends what was started: the appliance first, so that it does not miss its devices.
stop_all() {
  trap - EXIT
  stop_process "${daemon:-}"
  stop_process "${world:-}"
}

stop_process() {
  [ -n "$1" ] || return 0
  kill "$1" 2>/dev/null || return 0
  for _ in $(seq 100); do
    kill -0 "$1" 2>/dev/null || return 0
    sleep 0.1
  done
  kill -9 "$1" 2>/dev/null || true
}
