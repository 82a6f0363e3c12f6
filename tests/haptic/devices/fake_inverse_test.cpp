// The replacement of the Inverse3's service by itself: a plain client, and calls that are against its rules.
#include <limits>

// One thread uses the socket.
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#include <gtest/gtest.h>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <nlohmann/json.hpp>

#include "tests/haptic/devices/fake_vendor/fake_inverse_service.h"
#include "tests/support/eventually.h"

namespace fettle::haptic {
namespace {

using fake::FakeInverseService;
using fake::InverseForm;
using nlohmann::json;
using tests::eventually;
namespace beast = boost::beast;
using tcp = boost::asio::ip::tcp;

class PlainClient {
 public:
  explicit PlainClient(const FakeInverseService& service) {
    const std::string at = service.address();
    const std::size_t colon = at.find(':');
    tcp::resolver resolver(context_);
    boost::asio::connect(socket_.next_layer(), resolver.resolve(at.substr(0, colon), at.substr(colon + 1)));
    socket_.next_layer().set_option(tcp::no_delay(true));  // else the second of two messages waits
    socket_.handshake(at, "/");
  }
  json read() {
    beast::flat_buffer buffer;
    socket_.read(buffer);
    return json::parse(beast::buffers_to_string(buffer.data()));
  }
  void write(const std::string& text, bool is_text = true) {
    socket_.text(is_text);
    socket_.write(boost::asio::buffer(text));
  }
  json ask(const std::string& text, bool is_text = true) {
    write(text, is_text);
    return read();
  }
  void close() { socket_.close(beast::websocket::close_code::normal); }

 private:
  boost::asio::io_context context_;
  beast::websocket::stream<tcp::socket> socket_{context_};
};

std::string force(const char* key, double z, const char* id = "049D") {
  return json{{"inverse3",
               {{{"device_id", id},
                 {"commands", {{"set_cursor_force", {{key, {{"x", 0.0}, {"y", 0.0}, {"z", z}}}}}}}}}}}
      .dump();
}
std::string said(const FakeInverseService& service) {
  std::string text;
  for (const std::string& rule : service.rules.broken()) text += rule + "; ";
  return text;
}

TEST(FakeInverseServiceTest, SpeaksAsDocumented) {
  FakeInverseService service;
  PlainClient client(service);
  const json first = client.read();
  EXPECT_EQ(first["inverse3"][0]["device_id"], "049D");
  EXPECT_TRUE(first["inverse3"][0]["status"]["calibrated"].get<bool>());
  EXPECT_TRUE(first.contains("session_id"));
  const json state = client.ask(force("vector", 1.5));
  EXPECT_EQ(state["inverse3"][0]["state"]["cursor_position"]["y"], -0.14);
  EXPECT_EQ(service.received().force_n[2], 1.5);
  client.ask(force("vector", 0.0));
  client.close();
  EXPECT_TRUE(eventually([&] { return service.received().connections == 0; }));
  EXPECT_EQ(said(service), "");
  EXPECT_EQ(service.received().messages, 2U);
}

TEST(FakeInverseServiceTest, TheOlderFormNamesAForceOtherwise) {
  FakeInverseService service;
  service.change([](auto& w) { w.form = InverseForm::k31; });
  PlainClient client(service);
  EXPECT_FALSE(client.read().contains("session_id"));
  EXPECT_FALSE(client.ask(force("values", 0.0))["inverse3"][0].contains("status"));
  EXPECT_EQ(said(service), "");
  client.ask(force("vector", 0.0));
  EXPECT_NE(said(service).find("as this version of the service names it"), std::string::npos);
}

// Each of these messages is against a rule.
TEST(FakeInverseServiceTest, NoticesWhatIsAgainstTheRules) {
  FakeInverseService service;
  service.change([](auto& w) {
    w.units.push_back({});
    w.units[1].id = "0002";
    w.units[1].calibrated = false;
  });
  {
    PlainClient client(service);
    client.write(force("vector", 0.0));  // before the inventory was read: seen only where it came as early
    client.read();
    client.read();
    for (const char* text : {"[]", R"({"speed":1})", R"({"inverse3":[{"commands":{}}]})",
                             R"({"inverse3":[{"device_id":"049D","commands":{}}]})"})
      client.ask(text);
    client.ask(force("vector", std::numeric_limits<double>::quiet_NaN()));
    client.ask(force("vector", 0.0), false);
    client.ask(force("vector", 40.0));
    client.ask(force("vector", 1.0, "0002"));
    service.change([](auto& w) { w.answer = fake::InverseAnswer::kNothing; });
    client.write(force("vector", 1.0));
    client.write(force("vector", 1.0));
    EXPECT_TRUE(eventually([&] { return service.received().messages == 10; }));
    service.change([](auto& w) { w.answer = fake::InverseAnswer::kState; });
    client.read();
    client.read();
  }  // neither a zero nor the closing handshake
  EXPECT_TRUE(eventually([&] { return service.received().connections == 0; }));
  const std::string heard = said(service);
  for (const char* rule :
       {"a message is an object of JSON", "a message names kinds of devices", "a command names its device",
        "a device's command is a finite force", "messages are text",
        "a force is within what the device gives", "a device that is not calibrated gets no force",
        "a message follows the answer to the one before", "the closing handshake",
        "the last force of a connection is zero"})
    EXPECT_NE(heard.find(rule), std::string::npos) << rule << "\n" << heard;
}

}  // namespace
}  // namespace fettle::haptic
