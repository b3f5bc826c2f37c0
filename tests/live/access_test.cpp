#include "live/access.h"

#include <gtest/gtest.h>

#include <set>

namespace palpate::live {
namespace {

TEST(Access, TokensAre32HexadecimalDigitsAndDiffer) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) {
    const std::string token = new_token();
    EXPECT_EQ(token.size(), 32U);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
    tokens.insert(token);
  }
  EXPECT_EQ(tokens.size(), 100U);
}

TEST(Access, TextsAreEqualOnlyAsAWhole) {
  EXPECT_TRUE(is_equal("abc", "abc"));
  EXPECT_FALSE(is_equal("abc", "abd"));
  EXPECT_FALSE(is_equal("abc", "ab"));
  EXPECT_FALSE(is_equal("", "a"));
}

TEST(Access, OnlyOwnHostsAreAccepted) {
  for (const char* host : {"localhost", "localhost:8800", "LocalHost:1", "127.0.0.1:65535", "[::1]:8800"})
    EXPECT_TRUE(is_own_host(host, true)) << host;
  for (const char* host :
       {"", "evil.example", "evil.example:8800", "localhost.evil.example:1", "127.0.0.1.evil.example",
        "192.168.0.7:8800", "localhost:x", "localhost:123456789", "[::1", "127.0.0.1:1:2"})
    EXPECT_FALSE(is_own_host(host, true)) << host;
  EXPECT_TRUE(is_own_host("192.168.0.7:8800", false)) << "an address has no name that could be rebound";
  EXPECT_TRUE(is_own_host("[fe80::1]:8800", false));
  EXPECT_FALSE(is_own_host("evil.example", false));
}

TEST(Access, TheOriginIsThePageOfThatHost) {
  EXPECT_TRUE(is_own_origin("http://localhost:8800", "localhost:8800"));
  for (const char* origin :
       {"", "null", "http://localhost", "http://localhost:8801", "https://localhost:8800",
        "http://evil.example", "http://localhost:8800.evil.example"})
    EXPECT_FALSE(is_own_origin(origin, "localhost:8800")) << origin;
  EXPECT_FALSE(is_own_origin("http://", ""));
}

}  // namespace
}  // namespace palpate::live
