#include "virtual_cell/world/emulated_board.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "base/clock.hpp"
#include "contract/result_codes.hpp"

namespace beltpick::virtual_cell {
namespace {

using host::PinLink;
using host::PinMessage;
using Kind = PinMessage::Kind;

constexpr int kReady_ms = 20'000;
constexpr int kEnd_ms = 2'000;
// From an edge of the trigger at the camera to the same edge of its strobe at the board: two opto-couplers.
constexpr std::uint64_t kStrobeDelayCycles = 20 * host::kCyclesPerUs;

// The emulator finds its end of the socket as this descriptor.
constexpr int kSocketThere = 3;

Result<pid_t> spawn(const TriggerBoardChoice& choice, const std::string& line, int socket) {
  const std::string descriptor = std::to_string(kSocketThere);
  const char* words[] = {choice.emulator.c_str(), "--elf", choice.firmware.c_str(), "--line", line.c_str(), "--pins",
                         descriptor.c_str(),      nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, socket, kSocketThere);
  // What simavr says of the file it loads is not the cell's answer.
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t process = 0;
  const int error =
      posix_spawn(&process, choice.emulator.c_str(), &actions, nullptr, const_cast<char**>(words), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return process;
  return failure(ResultCode::kServiceUnreachable, "emulated trigger board: %s cannot be run (%s); build it anew",
                 choice.emulator.c_str(), std::strerror(error));
}

}  // namespace

Result<std::unique_ptr<TriggerBoard>> EmulatedBoard::start(const TriggerBoardChoice& choice, const std::string& link,
                                                           OnEdge on_edge) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
    return failure(ResultCode::kServiceUnreachable, "emulated trigger board: no socket pair (%s)",
                   std::strerror(errno));
  }
  const auto process = spawn(choice, link, ends[1]);
  ::close(ends[1]);
  if (!process) {
    ::close(ends[0]);
    return std::unexpected(process.error());
  }
  std::unique_ptr<EmulatedBoard> board(new EmulatedBoard(ends[0], *process, link, std::move(on_edge)));
  if (const std::string why = board->link_.await_ready(kReady_ms); !why.empty()) {
    return failure(ResultCode::kServiceUnreachable, "emulated trigger board: the emulator did not start: %s",
                   why.c_str());
  }
  board->thread_ = std::thread([raw = board.get()] { raw->run(); });
  return board;
}

EmulatedBoard::EmulatedBoard(int socket, pid_t process, std::string line, OnEdge on_edge)
    : link_(socket), process_(process), line_(std::move(line)), on_edge_(std::move(on_edge)) {}

EmulatedBoard::~EmulatedBoard() {
  stopping_ = true;
  link_.hang_up();
  if (thread_.joinable()) thread_.join();
  const Stopwatch waiting;
  while (::waitpid(process_, nullptr, WNOHANG) == 0) {
    if (waiting.elapsed_ms() > kEnd_ms) ::kill(process_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void EmulatedBoard::run() {
  PinMessage message;
  while (link_.receive(message, true) == PinLink::Received::kMessage) {
    if (message.kind == Kind::kEdge) pass_edge(message);
    if (message.kind == Kind::kReset) std::fputs("virtual cell: the watchdog has reset the trigger board\n", stderr);
  }
  if (!stopping_) std::fputs("virtual cell: the emulated trigger board has ended\n", stderr);
}

void EmulatedBoard::pass_edge(const PinMessage& message) {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  in_edge_ = std::this_thread::get_id();
  on_edge_({static_cast<host::Pin>(message.pin), message.level != 0,
            static_cast<std::uint32_t>(message.cycle / host::kCyclesPerUs),
            std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec});
  in_edge_ = std::thread::id();
  link_.send({Kind::kGoOn, 0, 0, 0});
}

// Upon the trigger's edge the camera's answer reaches the board as long after it as it does on a bench; what the camera
// does by itself, when it does it.
void EmulatedBoard::set_strobe(bool active) {
  set_input(host::InputPin::kStrobe, active, in_edge_.load() == std::this_thread::get_id() ? kStrobeDelayCycles : 0);
}

void EmulatedBoard::set_input(host::InputPin pin, bool level, std::uint64_t after_cycles) {
  link_.send({Kind::kInput, static_cast<std::uint8_t>(pin), level, after_cycles});
}

void EmulatedBoard::hang() { link_.send({Kind::kHang, 0, 0, 0}); }

void EmulatedBoard::set_line_noise(double share) {
  link_.send({Kind::kNoise, 0, 0, static_cast<std::uint64_t>(std::llround(share * 1e6))});
}

void EmulatedBoard::cut_line(bool cut) { link_.send({Kind::kMute, 0, cut, 0}); }

}  // namespace beltpick::virtual_cell
