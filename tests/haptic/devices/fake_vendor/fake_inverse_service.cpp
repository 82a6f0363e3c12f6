#include "tests/haptic/devices/fake_vendor/fake_inverse_service.h"

// Each socket is used by one thread: no fences are needed between threads of Asio, which the thread sanitizer does not know.
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#include "tests/haptic/devices/fake_vendor/frame_by_frame.h"

#include <cmath>

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace fettle::fake {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Error = boost::system::error_code;

// A program that the test starts must not keep the port open.
void closeOnExec(int file) {
  ::fcntl(file, F_SETFD, FD_CLOEXEC);
}

double lengthOf(const std::array<double, 3>& v) {
  return std::hypot(v[0], v[1], v[2]);
}

// The text that is answered, where it is not the plain state.
std::string attackedAnswer(InverseAnswer answer, InverseForm form, std::vector<InverseUnit> units) {
  std::string plain = stateUpdate(form, units);
  const auto withPosition = [&](const std::string& position) {
    const std::size_t at = plain.find("\"cursor_position\":");
    const std::size_t from = plain.find('{', at);
    return plain.replace(from, plain.find('}', from) + 1 - from, position);
  };
  switch (answer) {
    case InverseAnswer::kNotJson:
      return "HTTP/1.1 500 \x01 no";
    case InverseAnswer::kCutShort:
      return plain.substr(0, plain.size() / 2);
    case InverseAnswer::kNoState:
      return R"({"inverse3":[{"device_id":")" + units.front().id + R"("}]})";
    case InverseAnswer::kNoPosition:
      return withPosition(R"({"x":0.1,"y":-0.1})");
    case InverseAnswer::kHuge:
      return withPosition(R"({"x":1e30,"y":-0.14,"z":0.2})");
    case InverseAnswer::kNull:
      return withPosition(R"({"x":null,"y":null,"z":null})");
    case InverseAnswer::kWords:
      return withPosition(R"({"x":"left","y":"0.1","z":"0.2"})");
    case InverseAnswer::kOtherDevice:
      for (InverseUnit& unit : units) unit.id = "FFFF";
      return stateUpdate(form, units);
    case InverseAnswer::kLong:
      return std::string(8 << 20, ' ') + plain;
    default:
      return plain;
  }
}

}  // namespace

struct FakeInverseService::Listener {
  asio::io_context context;
  tcp::acceptor acceptor{context};
  std::list<Connection> connections;  // of the listening thread
};

class FakeInverseService::Connection {
 public:
  Connection(FakeInverseService& service, tcp::socket socket)
      : service_(service),
        wake_(::fcntl(socket.native_handle(), F_DUPFD_CLOEXEC, 0)),
        socket_(FrameByFrame(std::move(socket))),
        thread_([this] { run(); }) {}
  ~Connection() {
    // Ends what the thread waits for. By a file of its own: the thread may be closing the socket.
    ::shutdown(wake_, SHUT_RDWR);
    thread_.join();
    ::close(wake_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

 private:
  [[nodiscard]] Wishes wishes() const {
    const std::lock_guard lock(service_.mutex_);
    return service_.wishes_;
  }
  [[nodiscard]] tcp::socket& wire() { return socket_.next_layer().socket(); }
  // Of what the program is to say only after an answer; a close or a ping may come at any time.
  [[nodiscard]] bool nothingMoreSaid() {
    unsigned char first = 0;
    if (::recv(wire().native_handle(), &first, 1, MSG_PEEK | MSG_DONTWAIT) != 1) return true;
    constexpr int kControlFrames = 8;
    return (first & 0x0F) >= kControlFrames;
  }

  void run() {
    try {
      serve();
    } catch (const boost::system::system_error&) {
      // The program went away, or the test ended it.
    }
    Error ignored;
    wire().shutdown(tcp::socket::shutdown_both, ignored);
    const std::lock_guard lock(service_.mutex_);
    if (counted_) --service_.received_.connections;
  }

  // The upgrade of HTTP; false where the service takes no program.
  bool accept() {
    if (!service_.waitWhile([](const Wishes& w) { return w.is_silent; })) return false;
    http::request<http::empty_body> request;
    http::read(wire(), read_, request);
    service_.rules.check(websocket::is_upgrade(request) && !request[http::field::host].empty(),
                         "a program asks for a WebSocket");
    if (wishes().refuses) {
      http::response<http::empty_body> no(http::status::service_unavailable, 11);
      no.prepare_payload();
      http::write(wire(), no);
      return false;
    }
    socket_.accept(request);
    const std::lock_guard lock(service_.mutex_);
    counted_ = true;
    ++service_.received_.connections;
    ++service_.received_.ever_connected;
    return true;
  }

  void serve() {
    wire().set_option(tcp::no_delay(true));
    if (!accept()) return;
    service_.rules.check(read_.size() == 0 && nothingMoreSaid(),
                         "a program's first message follows the service's first");
    const Wishes first = wishes();
    socket_.text(true);
    socket_.write(asio::buffer(inventory(first.form, first.units)));
    for (;;) {
      Error error;
      socket_.read(read_, error);
      if (error) {
        // An end that the test made is not the program's.
        if (ended_by_test_ || service_.isStopping()) return;
        service_.rules.check(stood_ || error == websocket::error::closed,
                             "a connection ends by the closing handshake");
        service_.rules.check(stood_ || lengthOf(last_) == 0.0, "the last force of a connection is zero");
        return;
      }
      if (!answer()) return;
    }
  }

  // One message; false where the connection is to end.
  bool answer() {
    const std::string message = beast::buffers_to_string(read_.data());
    read_.consume(read_.size());
    const Wishes now = wishes();
    service_.rules.check(socket_.got_text(), "messages are text");
    const InverseCommand command = readCommand(now.form, message);
    service_.rules.check(command.against.empty(), command.against.c_str());
    service_.note(command, now.units, now.limit_n);
    for (const InverseForce& force : command.forces) last_ = force.n;

    if (!service_.waitWhile([](const Wishes& w) { return w.answer == InverseAnswer::kNothing; }))
      return false;
    if (now.slowness.count() > 0 && !service_.waitFor(now.slowness)) return false;
    service_.rules.check(answered_twice_ || nothingMoreSaid(),
                         "a message follows the answer to the one before");
    return send(wishes(), command.asks_full_state);
  }

  bool send(const Wishes& now, bool full) {
    const std::string text = full && now.answer == InverseAnswer::kState
                                 ? inventory(now.form, now.units)
                                 : attackedAnswer(now.answer, now.form, now.units);
    socket_.text(now.answer != InverseAnswer::kBinary);
    switch (now.answer) {
      case InverseAnswer::kCloses:
        ended_by_test_ = true;
        socket_.close(websocket::close_code::going_away);
        return false;
      case InverseAnswer::kDrops:
        ended_by_test_ = true;
        return false;
      case InverseAnswer::kHugeFrame: {
        ended_by_test_ = true;  // a program can only leave it
        constexpr std::array<unsigned char, 10> kHeader{0x81, 0x7F, 0, 0, 1, 0, 0, 0, 0, 0};
        asio::write(wire(), asio::buffer(kHeader));
        return true;
      }
      case InverseAnswer::kInPieces:
        socket_.ping({});
        socket_.write_some(false, asio::buffer(text.data(), text.size() / 2));
        socket_.write_some(true, asio::buffer(text.data() + text.size() / 2, text.size() - text.size() / 2));
        return true;
      case InverseAnswer::kLong:
        ended_by_test_ = true;  // likewise
        socket_.write(asio::buffer(text));
        return true;
      case InverseAnswer::kTwice:
        answered_twice_ = true;  // a program may take the second for the next answer
        socket_.write(asio::buffer(text));
        [[fallthrough]];
      default:
        socket_.write(asio::buffer(text));
        return true;
    }
  }

  FakeInverseService& service_;
  const int wake_;
  websocket::stream<FrameByFrame> socket_;
  beast::flat_buffer read_;
  std::array<double, 3> last_{};  // force that the program asked for
  bool counted_ = false;
  bool ended_by_test_ = false;
  bool answered_twice_ = false;
  bool stood_ = false;  // the last answer, for as long as the test wanted
  std::thread thread_;  // the last: it uses all of the above
};

FakeInverseService::FakeInverseService() {
  start();
}

FakeInverseService::~FakeInverseService() {
  stop();
}

std::string FakeInverseService::address() const {
  return "localhost:" + std::to_string(port_);
}

void FakeInverseService::change(const std::function<void(Wishes&)>& how) {
  {
    const std::lock_guard lock(mutex_);
    how(wishes_);
  }
  changed_.notify_all();
}

FakeInverseService::Received FakeInverseService::received() const {
  const std::lock_guard lock(mutex_);
  return received_;
}

void FakeInverseService::forgetReceived() {
  const std::lock_guard lock(mutex_);
  const int connections = received_.connections;
  received_ = {};
  received_.connections = connections;
}

void FakeInverseService::start() {
  if (listener_ != nullptr) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = false;
  }
  listener_ = std::make_unique<Listener>();
  const tcp::endpoint at(asio::ip::address_v4::loopback(), port_);
  listener_->acceptor.open(at.protocol());
  closeOnExec(listener_->acceptor.native_handle());
  listener_->acceptor.set_option(tcp::acceptor::reuse_address(true));
  listener_->acceptor.bind(at);
  listener_->acceptor.listen();
  port_ = listener_->acceptor.local_endpoint().port();
  listening_ = std::thread([this] { listen(); });
}

void FakeInverseService::stop() {
  if (listener_ == nullptr) return;
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  ::shutdown(listener_->acceptor.native_handle(), SHUT_RDWR);  // accept() returns
  listening_.join();
  listener_.reset();
}

void FakeInverseService::listen() {
  for (;;) {
    Error error;
    tcp::socket socket(listener_->context);
    listener_->acceptor.accept(socket, error);
    if (error) return;
    closeOnExec(socket.native_handle());
    listener_->connections.emplace_back(*this, std::move(socket));
  }
}

bool FakeInverseService::isStopping() const {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

bool FakeInverseService::waitWhile(const std::function<bool(const Wishes&)>& holds) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return stopping_ || !holds(wishes_); });
  return !stopping_;
}

bool FakeInverseService::waitFor(std::chrono::microseconds length) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, length, [&] { return stopping_; });
}

void FakeInverseService::note(const InverseCommand& command, const std::vector<InverseUnit>& units,
                              double limit_n) {
  const std::lock_guard lock(mutex_);
  ++received_.messages;
  for (const InverseForce& force : command.forces) {
    const double strength = lengthOf(force.n);
    rules.check(strength <= limit_n * 1.001, "a force is within what the device gives");
    for (std::size_t i = 0; i < units.size(); ++i) {
      if (units[i].id != force.id) continue;  // a device that has just gone: nobody feels it
      rules.check(units[i].calibrated || strength == 0.0, "a device that is not calibrated gets no force");
      (i == 0 ? received_.force_n : received_.other_force_n) = force.n;
      if (i > 0) continue;
      received_.strongest_n = std::max(received_.strongest_n, strength);
      received_.forces_n.push_back(static_cast<float>(strength));
    }
  }
}

}  // namespace fettle::fake
