#include "server.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <csignal>
#include <deque>
#include <random>
#include <set>

namespace cli::live {

namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Request = http::request<http::string_body>;

constexpr auto frame = std::chrono::microseconds(16667);
constexpr std::size_t largest_message = 65536;

// Of the system's random numbers.
std::string random_word() {
  std::random_device random;
  std::string out;
  for (int k = 0; k < 32; ++k) out += "0123456789abcdef"[random() & 15];
  return out;
}

class Socket;

// What sessions share.
struct Service {
  Simulation& simulation;
  const std::string& page;
  std::string port, word;
  std::set<std::shared_ptr<Socket>> sockets;

  // Also for names that others let point here: Host says what the browser thinks it talks to.
  bool own_host(std::string_view host) const { return host == "127.0.0.1:" + port || host == "localhost:" + port; }
  bool own_origin(std::string_view origin) const {
    return origin == "http://127.0.0.1:" + port || origin == "http://localhost:" + port;
  }
};

// A page that looks on. A slow one misses frames; messages of words reach it all.
class Socket : public std::enable_shared_from_this<Socket> {
 public:
  Socket(tcp::socket&& socket, Service& service) : stream_(std::move(socket)), service_(service) {}

  void begin(const Request& request) {
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.read_message_max(largest_message);
    stream_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->service_.sockets.insert(self);
      self->read();
    });
  }
  void send_state(const std::vector<float>& state) {
    if (writing_) return;
    const auto* bytes = reinterpret_cast<const char*>(state.data());
    write(std::string(bytes, bytes + state.size() * sizeof(float)), false);
  }
  void send_text(const std::string& text) {
    if (writing_) waiting_.push_back(text);
    else write(text, true);
  }

 private:
  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->leave();
      const json command = json::parse(beast::buffers_to_string(self->buffer_.data()), nullptr, false);
      self->buffer_.consume(self->buffer_.size());
      const std::string refused = command.is_object() ? self->service_.simulation.obey(command) : "that is no JSON object";
      if (!refused.empty()) self->send_text(json{{"error", refused}}.dump(-1, ' ', false, json::error_handler_t::replace));
      self->read();
    });
  }
  void write(std::string message, bool text) {
    out_ = std::move(message), writing_ = true;
    stream_.text(text);
    stream_.async_write(asio::buffer(out_), [self = shared_from_this()](error_code error, std::size_t) {
      self->writing_ = false;
      if (error) return self->leave();
      if (self->waiting_.empty()) return;
      std::string next = std::move(self->waiting_.front());
      self->waiting_.pop_front();
      self->write(std::move(next), true);
    });
  }
  void leave() {
    service_.sockets.erase(shared_from_this());
    service_.simulation.obey({{"do", "push"}, {"point", {0, 0, 0}}, {"force", {0, 0, 0}}});  // a hand that is gone pushes no more
  }

  websocket::stream<beast::tcp_stream> stream_;
  Service& service_;
  beast::flat_buffer buffer_;
  std::string out_;
  std::deque<std::string> waiting_;
  bool writing_ = false;
};

// One request: the page, or the beginning of a WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket&& socket, Service& service) : stream_(std::move(socket)), service_(service) {
    parser_.body_limit(largest_message);
  }

  void begin() {
    stream_.expires_after(std::chrono::seconds(10));
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->answer(self->parser_.get());
    });
  }

 private:
  void answer(const Request& request) {
    const auto header = [&](http::field name) { return std::string_view(request[name].data(), request[name].size()); };
    const std::string_view target(request.target().data(), request.target().size());
    const std::string home = "/" + service_.word + "/";
    const bool here = service_.own_host(header(http::field::host)) && (target == home || target == home + "ws");
    const bool upgrade = target == home + "ws" && websocket::is_upgrade(request);
    const std::string_view origin = header(http::field::origin);
    if (!here)
      return reply(http::status::not_found, "There is nothing here: the address is the one that dyn view --live printed.\n",
                   "text/plain");
    if (!(origin.empty() && !upgrade) && !service_.own_origin(origin))
      return reply(http::status::forbidden, "Pages of other origins are refused.\n", "text/plain");
    if (!upgrade) return reply(http::status::ok, target == home ? service_.page : "", "text/html; charset=utf-8");
    stream_.expires_never();
    std::make_shared<Socket>(stream_.release_socket(), service_)->begin(request);
  }
  void reply(http::status status, const std::string& body, const char* type) {
    response_ = {status, 11, body};
    response_.set(http::field::content_type, type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Content-Security-Policy", "frame-ancestors 'none'");
    response_.keep_alive(false);
    response_.prepare_payload();
    http::async_write(stream_, response_, [self = shared_from_this()](error_code, std::size_t) {
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  Service& service_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::response<http::string_body> response_;
};

class Listener {
 public:
  Listener(asio::io_context& io, Service& service, unsigned short port) : acceptor_(io), pause_(io), service_(service) {
    const tcp::endpoint endpoint(asio::ip::address_v4::loopback(), port);
    error_code error;
    acceptor_.open(endpoint.protocol(), error);
#ifndef _WIN32  // where it would let another process take the port
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
#endif
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error == asio::error::address_in_use)
      fail("port " + std::to_string(port) +
           " of 127.0.0.1 is taken: give another one with --port, or none for one that is free.");
    if (error) fail("port " + std::to_string(port) + " of 127.0.0.1 cannot be listened on: " + error.message() + ".");
    accept();
  }
  unsigned short port() const { return acceptor_.local_endpoint().port(); }

 private:
  void accept() {
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) std::make_shared<Connection>(std::move(socket), service_)->begin();
      if (error) wait();
      else accept();
    });
  }
  // Out of descriptors the connection stays in the queue: accepting again at once would spin.
  void wait() {
    pause_.expires_after(std::chrono::milliseconds(100));
    pause_.async_wait([this](error_code error) {
      if (!error) accept();
    });
  }
  tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  Service& service_;
};

// 60 times a second, while someone looks on: steps, and what came of them.
class Clockwork {
 public:
  Clockwork(asio::io_context& io, Service& service) : timer_(io), service_(service) { tick(); }

 private:
  void tick() {
    timer_.expires_after(frame);
    timer_.async_wait([this](error_code error) {
      if (error) return;
      const auto now = std::chrono::steady_clock::now();
      const double wall = std::min(std::chrono::duration<double>(now - last_).count(), 0.1);
      last_ = now;
      if (!service_.sockets.empty()) go_on(wall);
      tick();
    });
  }
  void go_on(double wall) {
    Simulation& s = service_.simulation;
    s.go_on(wall);
    const auto state = s.state();
    for (const auto& socket : std::set(service_.sockets)) socket->send_state(state);
    if (s.failure() == told_) return;
    told_ = s.failure();
    if (!told_.empty())
      for (const auto& socket : std::set(service_.sockets))
        socket->send_text(json{{"error", told_}}.dump(-1, ' ', false, json::error_handler_t::replace));
  }
  asio::steady_timer timer_;
  Service& service_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::string told_;
};

}  // namespace

void serve(Simulation& simulation, const std::string& page, unsigned short port,
           const std::function<void(const std::string&)>& ready) {
  asio::io_context io(1);
  Service service{simulation, page, "", random_word(), {}};
  Listener listener(io, service, port);
  service.port = std::to_string(listener.port());
  Clockwork clockwork(io, service);
  asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([&](error_code, int) { io.stop(); });
  ready("http://127.0.0.1:" + service.port + "/" + service.word + "/");
  io.run();
  service.sockets.clear();
}

}  // namespace cli::live
