// Fuzzes the frame codec: any bytes as a wire, and any bytes as a message.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "check.hpp"
#include "protocol/messages.hpp"

using namespace beltpick::protocol;
using Bytes = std::vector<std::uint8_t>;
using Outcome = FrameDecoder::Outcome;

namespace {

std::size_t whole_frames = 0;
std::size_t damaged_frames = 0;

Bytes frame_of(const Bytes& message) {
  Bytes frame(kMaxFrame);
  frame.resize(encode_frame(message.data(), message.size(), frame.data(), frame.size()));
  return frame;
}

// A message that is read and written again is the same to the byte.
template <class Payload>
void check_payload(Type type, const Bytes& message) {
  Payload payload;
  if (!decode_payload(message.data(), message.size(), payload)) return;
  Bytes frame(kMaxFrame);
  frame.resize(encode(type, message[2], payload, frame.data(), frame.size()));
  Bytes same = message;
  same[0] = kVersion;
  same[1] = static_cast<std::uint8_t>(type);
  FUZZ_CHECK(frame == frame_of(same));
}

void check_message(const Bytes& message) {
  Header header;
  if (!decode_header(message.data(), message.size(), header)) return;
  check_payload<Arm>(Type::kArm, message);
  check_payload<Start>(Type::kStart, message);
  check_payload<Reply>(Type::kReply, message);
  check_payload<Identity>(Type::kIdentity, message);
  check_payload<StatusReport>(Type::kStatusReport, message);
  check_payload<FrameEvent>(Type::kFrameEvent, message);
  check_payload<DoneEvent>(Type::kDoneEvent, message);
  check_payload<FaultEvent>(Type::kFaultEvent, message);
  check_payload<InputsEvent>(Type::kInputsEvent, message);
}

void read_wire(const Bytes& wire) {
  FrameDecoder decoder;
  for (const std::uint8_t byte : wire) {
    const Outcome outcome = decoder.push(byte);
    FUZZ_CHECK(outcome == Outcome::kMore || byte == 0);
    damaged_frames += outcome == Outcome::kDamaged ? 1 : 0;
    if (outcome != Outcome::kMessage) continue;
    ++whole_frames;
    FUZZ_CHECK(decoder.size() > 0 && decoder.size() <= kMaxMessage);
    check_message({decoder.message(), decoder.message() + decoder.size()});
  }
  // Whatever came before, a zero ends it: the next frame is heard.
  decoder.push(0);
  const Bytes next{1, 2, 3, 0, 0xFF};
  Outcome outcome = Outcome::kMore;
  for (const std::uint8_t byte : frame_of(next)) outcome = decoder.push(byte);
  FUZZ_CHECK(outcome == Outcome::kMessage);
  FUZZ_CHECK(std::equal(next.begin(), next.end(), decoder.message(), decoder.message() + decoder.size()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const Bytes input(bytes, bytes + size);
  read_wire(input);
  if (size == 0 || size > kMaxMessage) {
    FUZZ_CHECK(frame_of(input).empty());
    return 0;
  }
  const Bytes frame = frame_of(input);
  FUZZ_CHECK(frame.size() == size + kCrcBytes + 2);
  FUZZ_CHECK(std::find(frame.begin(), frame.end(), 0) == frame.end() - 1);
  read_wire(frame);
  return 0;
}

const char* fuzz_shortfall() {
  if (whole_frames == 0) return "no whole frame";
  return damaged_frames == 0 ? "no damaged frame" : nullptr;
}
