#include "view/access.hpp"

#include <gtest/gtest.h>

#include "view/routes.hpp"

namespace sweepcast::test {
namespace {

using namespace view;

Credentials at(std::string_view host, std::string_view origin = {}) {
  return {"/", host, origin, {}, {}};
}

TEST(Access, TextsAreEqualOrNot) {
  EXPECT_TRUE(equal_in_constant_time("secret", "secret"));
  for (const char* wrong : {"", "s", "secre", "secrets", "secretsecret", "Secret"}) {
    EXPECT_FALSE(equal_in_constant_time(wrong, "secret")) << wrong;
  }
  EXPECT_FALSE(equal_in_constant_time("", ""));
}

TEST(Access, TheLoopbackIsReachedByItsOwnNamesAlone) {
  const AccessRules rules;
  for (const char* host : {"127.0.0.1", "127.0.0.1:8080", "localhost:1", "LOCALHOST", "[::1]:8080",
                           "[::1]", "127.1.2.3"}) {
    EXPECT_EQ(check_access(at(host), rules, false), Access::granted) << host;
  }
  for (const char* host : {"", "evil.example", "evil.example:8080", "127.0.0.1.evil.example",
                           "localhost.evil.example", "127.evil.example", "[::2]", "10.0.0.1"}) {
    EXPECT_EQ(check_access(at(host), rules, false), Access::wrong_host) << host;
  }
}

TEST(Access, PagesOfOtherServersMayNotAsk) {
  AccessRules rules;
  const char* host = "localhost:8080";
  EXPECT_EQ(check_access(at(host, "http://localhost:8080"), rules, false), Access::granted);
  for (const char* origin : {"http://localhost:9000", "https://evil.example", "null", "file://",
                             "http://localhost:8080.evil.example"}) {
    EXPECT_EQ(check_access(at(host, origin), rules, false), Access::foreign_page) << origin;
  }
  for (const char* origin :
       {"http://localhost:9000", "file://", "https://app.foxglove.dev", "http://127.0.0.1:8080"}) {
    EXPECT_EQ(check_access(at(host, origin), rules, true), Access::granted) << origin;
  }
  for (const char* origin : {"https://evil.example", "null", "http://localhost.evil.example",
                             "https://app.foxglove.dev.evil.example"}) {
    EXPECT_EQ(check_access(at(host, origin), rules, true), Access::foreign_page) << origin;
  }
  rules.origins = {"https://lichtblick.example"};
  EXPECT_EQ(check_access(at(host, "https://lichtblick.example"), rules, false), Access::granted);
}

TEST(Access, ATokenComesInAHeadTheQueryOrACookie) {
  const AccessRules rules{"s3cret", false, 8080, {}};
  Credentials from = at("robot.example:8080");
  EXPECT_EQ(check_access(from, rules, false), Access::no_token);
  for (const char* head : {"Bearer s3cre", "Bearer s3crets", "Bearer ", "s3cret", "Basic s3cret"}) {
    from.authorization = head;
    EXPECT_EQ(check_access(from, rules, false), Access::no_token) << head;
  }
  from.authorization = "Bearer s3cret";
  EXPECT_EQ(check_access(from, rules, false), Access::granted);
  from.authorization = {};
  for (const char* target : {"/?token=", "/?tokens3cret", "/?token=s3cret2", "/?xtoken=s3cret",
                             "/token=s3cret", "/?a=token=s3cret"}) {
    from.target = target;
    EXPECT_EQ(check_access(from, rules, false), Access::no_token) << target;
  }
  from.target = "/live?a=b&token=s3cret";
  EXPECT_EQ(check_access(from, rules, false), Access::granted);
  from.origin = "https://evil.example";  // who knows the token may come from anywhere
  EXPECT_EQ(check_access(from, rules, false), Access::granted);
  from.target = "/";
  from.cookie = "a=b; sweepcast_8080=s3cret";
  EXPECT_EQ(check_access(from, rules, false), Access::foreign_page);
  from.origin = "http://robot.example:8080";
  EXPECT_EQ(check_access(from, rules, false), Access::granted);
  for (const char* cookie : {"sweepcast_8081=s3cret", "xsweepcast_8080=s3cret", ";;",
                             "sweepcast_8080", "sweepcast_8080=s3cret2"}) {
    from.cookie = cookie;
    EXPECT_EQ(check_access(from, rules, false), Access::no_token) << cookie;
  }
}

TEST(Access, TokensHaveToFitAnAddress) {
  EXPECT_TRUE(check_token("aZ09-_.~"));
  for (const char* token : {"a b", "a&b", "a%41", "a\n", "\xc3\xa4"}) {
    EXPECT_FALSE(check_token(token)) << token;
  }
  EXPECT_FALSE(check_token(std::string(257, 'a')));
}

std::string head_of(const Answer& made, std::string_view name) {
  for (const auto& [key, value] : made.heads) {
    if (key == name) return value;
  }
  return {};
}

Answer get(std::string_view target, const AccessRules& rules = {},
           std::string_view method = "GET") {
  return answer({method, {target, "localhost", {}, {}, {}}, {}}, rules, nullptr);
}

TEST(Routes, EveryAnswerKeepsTheBrowserInBounds) {
  const AccessRules locked{"s3cret", true, 80, {}};
  for (const Answer& made : {get("/"), get("/nothing"), get("/", locked), get("/", {}, "POST")}) {
    EXPECT_NE(head_of(made, "Content-Security-Policy").find("default-src 'self'"),
              std::string::npos);
    EXPECT_EQ(head_of(made, "X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(head_of(made, "Referrer-Policy"), "no-referrer");
    EXPECT_FALSE(made.body.empty());
  }
  const std::string policy = head_of(get("/"), "Content-Security-Policy");
  EXPECT_NE(policy.find("'wasm-unsafe-eval'"), std::string::npos);
  EXPECT_NE(policy.find("worker-src 'self' blob:"), std::string::npos);
  EXPECT_EQ(policy.find("http"), std::string::npos);
  EXPECT_EQ(policy.find("unsafe-inline"), std::string::npos);
}

TEST(Routes, AnswerWhatThereIs) {
  const AccessRules locked{"s3cret", true, 80, {}};
  EXPECT_EQ(get("/").status, 200U);
  EXPECT_EQ(head_of(get("/"), "Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(get("/../etc/passwd").status, 404U);
  EXPECT_EQ(get("/original/0").status, 404U);
  EXPECT_EQ(get("/", {}, "POST").status, 405U);
  EXPECT_EQ(get("/healthz", locked).status, 200U);
  EXPECT_EQ(get("/", locked).status, 401U);
  EXPECT_EQ(head_of(get("/", locked), "WWW-Authenticate"), "Bearer");
  EXPECT_EQ(head_of(get("/?token=s3cret"), "Set-Cookie"), "");
  EXPECT_EQ(head_of(get("/?token=s3cret", locked), "Set-Cookie"),
            "sweepcast_80=s3cret; Path=/; HttpOnly; SameSite=Strict");
}

TEST(Routes, WebSocketsAreChosenByPathAndProtocol) {
  const auto choose = [](std::string_view target, std::string_view protocols) {
    return choose_upgrade({"GET", {target, "localhost", {}, {}, {}}, protocols}, {});
  };
  ASSERT_TRUE(choose("/live?x=y", "sweepcast.view.v1"));
  EXPECT_TRUE(choose("/live", "sweepcast.view.v1")->is_page);
  ASSERT_TRUE(choose("/", "foxglove.websocket.v1 , foxglove.sdk.v1"));
  EXPECT_EQ(choose("/", "foxglove.websocket.v1 , foxglove.sdk.v1")->subprotocol, "foxglove.sdk.v1");
  EXPECT_EQ(choose("/", "a,foxglove.websocket.v1")->subprotocol, "foxglove.websocket.v1");
  EXPECT_EQ(choose("/live", "").error().status, 400U);
  EXPECT_EQ(choose("/live", "sweepcast.view.v12").error().status, 400U);
  EXPECT_EQ(choose("/", "sweepcast.view.v1").error().status, 400U);
  EXPECT_EQ(choose("/other", "sweepcast.view.v1").error().status, 404U);
}

}  // namespace
}  // namespace sweepcast::test
