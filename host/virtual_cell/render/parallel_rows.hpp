// Runs rows on two threads; what a row computes must not depend on the others.
#pragma once

#include <thread>
#include <vector>

namespace beltpick::virtual_cell {

template <class DoRow>
void in_parallel(int rows, const DoRow& do_row) {
  constexpr int kThreads = 2;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int row = t; row < rows; row += kThreads) do_row(row);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace beltpick::virtual_cell
