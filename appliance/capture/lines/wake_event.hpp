// A wake event: what one thread raises to end another's poll().
#pragma once

namespace beltpick::capture {

// Throws std::system_error. Closed by its owner.
int new_wake_event();
void raise_wake_event(int fd);
void clear_wake_event(int fd);

}  // namespace beltpick::capture
