// PlaneStore: places the planes of a plan in one block of memory and gives their rows. Internal to decode.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "decode/bit_kernels.hpp"
#include "decode/gray_cells.hpp"
#include "decode/plan.hpp"

namespace beltpick::decode {

class PlaneStore {
 public:
  static constexpr std::size_t kMaxPlanes = 192;
  static constexpr std::size_t kAlignment = 64;

  PlaneStore() = default;
  explicit PlaneStore(std::span<std::byte> memory) : memory_(memory) {}

  // Bytes that a plan with `state_bytes` a pixel takes at most, alignment of every plane and of the rows of two Gray
  // codes included, and what is read beyond the last.
  static std::size_t bytes_for(int rows, int cols, int state_bytes) {
    constexpr std::size_t kRowPadding = 2 * 16 * bit_row_bytes(1);
    return static_cast<std::size_t>(rows) *
               (static_cast<std::size_t>(cols) * static_cast<std::size_t>(state_bytes) + kRowPadding) +
           kMaxPlanes * kAlignment + kBitRowsReadAhead;
  }

  // False where the planes do not fit.
  bool place(const FoldPlan& plan, int rows, int cols, int pixel_bytes) {
    if (plan.planes.size() > kMaxPlanes) return false;
    std::size_t at = 0;
    for (std::size_t p = 0; p < plan.planes.size(); ++p) {
      planes_[p] = {at, row_bytes(plan.planes[p], cols, pixel_bytes)};
      const std::size_t bytes = planes_[p].row_bytes * static_cast<std::size_t>(rows);
      at += (bytes + kAlignment - 1) / kAlignment * kAlignment;
    }
    return at + kBitRowsReadAhead <= memory_.size();
  }

  // Row `row` of plane `plane`; null for kNone.
  template <class T>
  [[nodiscard]] T* row(int plane, int row) const {
    if (plane == kNone) return nullptr;
    const Plane& placed = planes_[static_cast<std::size_t>(plane)];
    return reinterpret_cast<T*>(memory_.data() + placed.offset + static_cast<std::size_t>(row) * placed.row_bytes);
  }

 private:
  struct Plane {
    std::size_t offset = 0, row_bytes = 0;
  };

  static std::size_t row_bytes(PlaneKind kind, int cols, int pixel_bytes) {
    if (kind == PlaneKind::kBits) return bit_row_bytes(cols);
    return static_cast<std::size_t>(cols) * static_cast<std::size_t>(plane_bits(kind, pixel_bytes)) / 8;
  }

  std::span<std::byte> memory_;
  std::array<Plane, kMaxPlanes> planes_{};
};

}  // namespace beltpick::decode
