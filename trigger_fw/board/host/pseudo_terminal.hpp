// PseudoTerminal: a serial line made by the kernel; one end is ours, the other a tty that any program can open.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace beltpick::host {

class PseudoTerminal {
 public:
  // `link`: where a symbolic link to the tty is made (replacing an older link), empty for none. Throws
  // std::system_error.
  explicit PseudoTerminal(const std::string& link);
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  // Our end, for poll().
  [[nodiscard]] int fd() const { return master_; }
  [[nodiscard]] const std::string& tty() const { return tty_; }

  // The bytes that are there, at most `capacity`; 0 when there are none. Never blocks.
  std::size_t read(std::uint8_t* bytes, std::size_t capacity);
  // Bytes that nobody reads are lost, as on a wire.
  void write(const std::uint8_t* bytes, std::size_t count);

 private:
  void make_link(const std::string& link);

  int master_ = -1;
  int slave_ = -1;  // held open, so that the line survives a client's coming and going
  std::string tty_;
  std::string link_;
};

}  // namespace beltpick::host
