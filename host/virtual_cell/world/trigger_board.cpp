#include "virtual_cell/world/trigger_board.hpp"

#include <exception>
#include <utility>

#include "contract/result_codes.hpp"
#include "host/board.hpp"
#include "virtual_cell/world/emulated_board.hpp"

namespace beltpick::virtual_cell {
namespace {

// The core on this PC.
class HostBoard final : public TriggerBoard {
 public:
  HostBoard(const std::string& link, OnEdge on_edge)
      : board_({.link = link, .belt_stopped = true, .emergency_stop = false, .on_edge = std::move(on_edge)}) {}

  [[nodiscard]] std::string tty() const override { return board_.tty(); }
  void set_strobe(bool active) override { board_.set_strobe(active); }
  void set_belt_stopped(bool stopped) override { board_.set_belt_stopped(stopped); }
  void set_emergency_stop(bool pressed) override { board_.set_emergency_stop(pressed); }
  void hang() override { board_.hang(); }
  void set_line_noise(double share) override { board_.set_noise(share); }
  void cut_line(bool cut) override { board_.mute(cut); }

 private:
  host::Board board_;
};

}  // namespace

Result<std::unique_ptr<TriggerBoard>> make_trigger_board(const TriggerBoardChoice& choice, const std::string& link,
                                                         OnEdge on_edge) {
  if (choice.emulated) return EmulatedBoard::start(choice, link, std::move(on_edge));
  try {
    return std::make_unique<HostBoard>(link, std::move(on_edge));
  } catch (const std::exception& error) {
    return failure(ResultCode::kServiceUnreachable,
                   "virtual trigger board: %s; check that pseudo-terminals are to be had", error.what());
  }
}

}  // namespace beltpick::virtual_cell
