#include "service/address_book.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace beltpick::service {
namespace {

constexpr std::array<std::uint8_t, 12> kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};  // IPv4 in IPv6

bool is_v4(const ClientAddress& address) { return std::equal(kMapped.begin(), kMapped.end(), address.key.begin()); }

}  // namespace

ClientAddress client_address(const sockaddr* address) {
  ClientAddress client;
  if (address == nullptr) return client;
  if (address->sa_family == AF_INET) {
    std::copy(kMapped.begin(), kMapped.end(), client.key.begin());
    std::memcpy(client.key.data() + kMapped.size(), &reinterpret_cast<const sockaddr_in*>(address)->sin_addr, 4);
  } else if (address->sa_family == AF_INET6) {
    std::memcpy(client.key.data(), &reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr, 16);
    if (!is_v4(client)) std::fill(client.key.begin() + 8, client.key.end(), std::uint8_t{0});
  }
  return client;
}

std::string address_text(const ClientAddress& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (is_v4(address)) return inet_ntop(AF_INET, address.key.data() + kMapped.size(), text.data(), text.size());
  return std::string(inet_ntop(AF_INET6, address.key.data(), text.data(), text.size())) + "/64";
}

AddressBook::AddressBook(int requests_per_minute)
    : per_us_(requests_per_minute / static_cast<double>(kMinute_us)), most_(requests_per_minute) {}

// Of a new address, on the page of the one that has been away longest.
AddressBook::Page& AddressBook::page(const ClientAddress& address, std::int64_t now_us) {
  const auto known = std::find_if(pages_.begin(), pages_.end(),
                                  [&](const Page& page) { return page.seen_us != 0 && page.address == address; });
  if (known != pages_.end()) return *known;
  Page& oldest = *std::min_element(pages_.begin(), pages_.end(),
                                   [](const Page& a, const Page& b) { return a.seen_us < b.seen_us; });
  oldest = {.address = address, .seen_us = now_us, .allowance = most_};
  return oldest;
}

int AddressBook::ask(const ClientAddress& address, std::int64_t now_us) {
  Page& of = page(address, now_us);
  of.allowance = std::min(most_, of.allowance + static_cast<double>(now_us - of.seen_us) * per_us_);
  of.seen_us = now_us;
  if (of.allowance < 1) return 1 + static_cast<int>((1 - of.allowance) / per_us_ / 1e6);
  of.allowance -= 1;
  return 0;
}

int AddressBook::locked_for(const ClientAddress& address, std::int64_t now_us) {
  const Page& of = page(address, now_us);
  const std::int64_t left_us = of.first_wrong_us + kMinute_us - now_us;
  return of.wrong < kWrongTokens || left_us <= 0 ? 0 : 1 + static_cast<int>(left_us / 1'000'000);
}

void AddressBook::wrong_token(const ClientAddress& address, std::int64_t now_us) {
  Page& of = page(address, now_us);
  if (of.wrong == 0 || now_us - of.first_wrong_us > kMinute_us) {
    of.wrong = 0;
    of.first_wrong_us = now_us;
  }
  ++of.wrong;
}

}  // namespace beltpick::service
