#include "serial.hpp"

#include <util/atomic.h>

#include "clock.hpp"

namespace beltpick {
namespace avr {

namespace {

// One writer, one reader, indices of one byte: no lock needed.
struct Ring {
  static constexpr uint8_t kSize = 64;
  volatile uint8_t bytes[kSize];
  volatile uint8_t head = 0;
  volatile uint8_t tail = 0;

  bool empty() const { return head == tail; }
  bool full() const { return next(tail) == head; }
  uint8_t count() const { return static_cast<uint8_t>((tail - head) & (kSize - 1U)); }
  void push(uint8_t byte) {
    bytes[tail] = byte;
    tail = next(tail);
  }
  uint8_t pop() {
    const uint8_t byte = bytes[head];
    head = next(head);
    return byte;
  }
  static uint8_t next(uint8_t index) { return static_cast<uint8_t>((index + 1U) % kSize); }
};

Ring incoming;
Ring outgoing;

constexpr uint8_t kSending = 1U << RXEN0 | 1U << TXEN0 | 1U << RXCIE0 | 1U << UDRIE0;
constexpr uint8_t kQuiet = 1U << RXEN0 | 1U << TXEN0 | 1U << RXCIE0;

}  // namespace

void start_serial() {
  UCSR0A = 1U << U2X0;
  UBRR0H = 0;
  UBRR0L = 3;  // exactly 500000 baud
  UCSR0C = 1U << UCSZ01 | 1U << UCSZ00;
  UCSR0B = kQuiet;
}

bool receive(uint8_t& byte) {
  if (incoming.empty()) return false;
  byte = incoming.pop();
  return true;
}

bool can_send() { return !outgoing.full(); }

void send(uint8_t byte) {
  outgoing.push(byte);
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { UCSR0B = kSending; }
}

bool ring_is_sent() { return outgoing.empty(); }

}  // namespace avr
}  // namespace beltpick

ISR(BELTPICK_VECTOR_RECEIVED) {
  using namespace beltpick::avr;
  const uint8_t byte = UDR0;
  if (!incoming.full()) incoming.push(byte);
  work_waits = true;
}

ISR(BELTPICK_VECTOR_SENDABLE) {
  using namespace beltpick::avr;
  if (outgoing.empty()) {
    UCSR0B = kQuiet;
    return;
  }
  UDR0 = outgoing.pop();
  if (outgoing.count() == Ring::kSize / 2) work_waits = true;  // there is room for a message again
}
