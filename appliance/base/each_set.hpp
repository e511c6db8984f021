// Masks and label images are mostly zero: passing over what is not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace beltpick {

// Calls visit(index) for every element that is not zero, in order. Zeros are passed over a word at a time. What is
// visited may be changed by the visit; what comes after it may not.
template <class Element, class Visit>
void each_set(std::span<Element> elements, Visit&& visit) {
  constexpr std::size_t kPerWord = sizeof(std::uint64_t) / sizeof(Element);
  const auto each = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (elements[i] != 0) visit(i);
    }
  };
  std::size_t i = 0;
  for (; i + kPerWord <= elements.size(); i += kPerWord) {
    std::uint64_t word = 0;
    std::memcpy(&word, elements.data() + i, sizeof(word));
    if (word != 0) each(i, i + kPerWord);
  }
  each(i, elements.size());
}

}  // namespace beltpick
