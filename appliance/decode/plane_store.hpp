// PlaneStore: places the planes of a plan in one block of memory and gives their rows. Internal to decode.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "decode/plan.hpp"

namespace beltpick::decode {

class PlaneStore {
 public:
  static constexpr std::size_t kMaxPlanes = 192;
  static constexpr std::size_t kAlignment = 64;

  PlaneStore() = default;
  explicit PlaneStore(std::span<std::byte> memory) : memory_(memory) {}

  // Bytes that a plan with `state_bytes` a pixel takes at most, alignment of every plane included.
  static std::size_t bytes_for(std::size_t pixels, int state_bytes) {
    return pixels * static_cast<std::size_t>(state_bytes) + kMaxPlanes * kAlignment;
  }

  // False where the planes do not fit.
  bool place(const FoldPlan& plan, int rows, int cols, int pixel_bytes) {
    if (plan.planes.size() > kMaxPlanes) return false;
    cols_ = cols;
    std::size_t at = 0;
    for (std::size_t p = 0; p < plan.planes.size(); ++p) {
      offset_[p] = at;
      const auto bytes = static_cast<std::size_t>(plane_bytes(plan.planes[p], pixel_bytes)) *
                         static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
      at += (bytes + kAlignment - 1) / kAlignment * kAlignment;
    }
    return at <= memory_.size();
  }

  // Row `row` of plane `plane`; null for kNone.
  template <class T>
  [[nodiscard]] T* row(int plane, int row) const {
    if (plane == kNone) return nullptr;
    return reinterpret_cast<T*>(memory_.data() + offset_[static_cast<std::size_t>(plane)]) +
           static_cast<std::ptrdiff_t>(row) * cols_;
  }

 private:
  std::span<std::byte> memory_;
  std::array<std::size_t, kMaxPlanes> offset_{};
  int cols_ = 0;
};

}  // namespace beltpick::decode
