// PickPlan: which part of the present view may be offered next, and whether the view must be captured anew.
//
// A part that touched the one picked may have moved with it, so its pose is void. A part is told to touch something,
// not what, and that may be an object that was withheld: so a picked part that touched something voids the whole view,
// any other pick those that touched something. Parts that stand alone stay true while the belt stands. What was
// withheld may have come free once something was picked.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "contract/locate_result.hpp"

namespace beltpick::cycle {

class PickPlan {
 public:
  static constexpr int kMaxParts = 256;

  // A new view: its parts in pick order (see LocatedPart) and the number of objects withheld from it. Parts beyond
  // kMaxParts count as withheld.
  void load(std::span<const LocatedPart> parts, int withheld);
  void clear() { *this = PickPlan{}; }

  // The index of the part to offer, -1 when there is none.
  [[nodiscard]] int next() const;
  [[nodiscard]] int parts_left() const;
  // Objects of this view that cannot be picked: withheld, or without a reachable grasp.
  [[nodiscard]] int not_pickable() const { return withheld_ + without_grasp_; }
  // Why the first part without a reachable grasp has none; kOk where all have one.
  [[nodiscard]] ResultCode without_grasp_code() const { return without_grasp_code_; }
  // Something of this view may still be pickable after another look.
  [[nodiscard]] bool capture_again() const { return picked_ > 0 && (void_ > 0 || touched_ || not_pickable() > 0); }

  void picked(int index);
  void skipped(int index);

 private:
  enum class Part : std::uint8_t { kNone, kPickable, kGone, kSkipped, kVoid };

  std::array<Part, kMaxParts> parts_{};
  std::array<bool, kMaxParts> touches_{};
  int count_ = 0;
  int withheld_ = 0;
  int without_grasp_ = 0;
  ResultCode without_grasp_code_{};
  int picked_ = 0;
  int void_ = 0;
  bool touched_ = false;  // something picked touched its neighbour
};

}  // namespace beltpick::cycle
