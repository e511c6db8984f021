// Counts what each thread of this process takes from the heap and gives back: every malloc of the program and of its
// shared libraries passes heap_counter.cpp.
#pragma once

#include <string>
#include <vector>

namespace heap {

struct ThreadCount {
  std::string thread;  // as named with pthread_setname_np; threads of one name are added up
  long taken = 0;
  long given_back = 0;
};

// Forgets what was counted so far and counts from here on.
void start();
void stop();
// Per name of the threads that live, also of those that took nothing; of those that have ended as "ended".
std::vector<ThreadCount> counts();

}  // namespace heap
