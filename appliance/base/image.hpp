// ImageView: a row-major picture in memory that somebody else owns, addressed as (row, column).
#pragma once

#include <cassert>
#include <cstddef>
#include <type_traits>

namespace beltpick {

template <class T>
struct ImageView {
  T* data = nullptr;
  int rows = 0;
  int cols = 0;
  std::ptrdiff_t stride = 0;  // elements from one row to the next

  ImageView() = default;
  ImageView(T* data_, int rows_, int cols_) : ImageView(data_, rows_, cols_, cols_) {}
  ImageView(T* data_, int rows_, int cols_, std::ptrdiff_t stride_)
      : data(data_), rows(rows_), cols(cols_), stride(stride_) {}

  // A view of const elements from a view of mutable ones.
  template <class U>
    requires(std::is_same_v<const U, T> && !std::is_same_v<U, T>)
  ImageView(const ImageView<U>& other)  // NOLINT(google-explicit-constructor): as T* converts to const T*
      : ImageView(other.data, other.rows, other.cols, other.stride) {}

  T& operator()(int row, int col) const {
    assert(row >= 0 && row < rows && col >= 0 && col < cols);
    return data[row * stride + col];
  }
  [[nodiscard]] T* row(int r) const { return data + r * stride; }
  [[nodiscard]] bool contains(int row, int col) const { return row >= 0 && row < rows && col >= 0 && col < cols; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols); }
  [[nodiscard]] bool empty() const { return data == nullptr || rows == 0 || cols == 0; }
};

}  // namespace beltpick
