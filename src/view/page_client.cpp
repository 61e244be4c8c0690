#include "view/page_client.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::view {
namespace {

constexpr std::size_t kMostNotices = 16;

}  // namespace

Message text_message(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {true, {bytes.begin(), bytes.end()}, nullptr};
}

void WaitingSweeps::add(const SharedSweep& sweep) {
  const auto same = std::find_if(sweeps_.begin(), sweeps_.end(), [&](const SharedSweep& other) {
    return other->stream == sweep->stream;
  });
  if (same == sweeps_.end()) {
    sweeps_.push_back(sweep);
  } else {
    *same = sweep;
  }
}

SharedSweep WaitingSweeps::take() {
  SharedSweep first = std::move(sweeps_.front());
  sweeps_.erase(sweeps_.begin());
  return first;
}

PageClient::PageClient(const Show& show, Recording* recording, Clock::time_point now,
                       AskLevel ask_level)
    : show_(show),
      recording_(recording),
      ask_level_(std::move(ask_level)),
      state_due_(recording != nullptr) {
  if (recording != nullptr) player_.emplace(recording->size(), show.rate_hz, now);
}

Status PageClient::take(std::string_view message, bool is_text, Clock::time_point now) {
  if (!is_text) return fail(ErrorCode::invalid_argument, "a client sends text, not bytes");
  const auto command = read_command(message);
  if (!command) return tl::unexpected(command.error());
  if (command->kind == Command::Kind::more) {
    credit_ = std::min(kMostCredit, credit_ + std::min(command->number, kMostCredit));
    return {};
  }
  return play(*command, now);
}

Status PageClient::play(const Command& command, Clock::time_point now) {
  using Kind = Command::Kind;
  if (command.kind == Kind::override_level) {
    ask_level(command);
    return {};
  }
  if (!player_) {
    notify(NoticeLevel::warning, "live sweeps can be neither paused nor sought");
    return {};
  }
  if (command.kind == Kind::play) player_->play(now);
  if (command.kind == Kind::pause) player_->pause(now);
  if (command.kind == Kind::speed) player_->set_speed(command.speed, now);
  if (command.kind == Kind::loop) player_->set_loop(command.loop, now);
  if (command.kind == Kind::seek) {
    player_->seek(command.number, now);
    shown_.reset();
  }
  state_due_ = true;
  return {};
}

/// What comes of it, the robot's next status tells.
void PageClient::ask_level(const Command& command) {
  if (ask_level_ && ask_level_(command.robot, command.level)) return;
  notify(NoticeLevel::warning,
         command.robot +
             ": no level can be asked of it; it has to be connected, and its sender "
             "started with --allow-override");
}

void PageClient::notify(NoticeLevel level, const std::string& text) {
  if (notices_.size() == kMostNotices) notices_.pop_front();
  notices_.push_back(write_notice(level, text));
}

std::optional<Message> PageClient::next_text(Clock::time_point now) {
  if (std::exchange(hello_due_, false)) return text_message(write_hello(show_));
  if (std::exchange(state_due_, false)) return text_message(write_state(*player_, now));
  if (!notices_.empty()) {
    Message message = text_message(notices_.front());
    notices_.pop_front();
    return message;
  }
  if (!status_.empty()) return text_message(std::exchange(status_, {}));
  return std::nullopt;
}

/// Frames that the client had no credit for are passed over. A damaged one becomes a notice.
SharedSweep PageClient::next_of_recording(Clock::time_point now) {
  const bool was_playing = player_->playing();
  const std::uint32_t index = player_->index(now);
  if (was_playing && !player_->playing()) state_due_ = true;
  if (credit_ == 0 || shown_ == index) return nullptr;
  shown_ = index;
  auto sweep = recording_->sweep(index);
  if (sweep) return *sweep;
  notify(NoticeLevel::error, sweep.error().message);
  return nullptr;
}

SharedSweep PageClient::next_sweep(Clock::time_point now) {
  if (player_) return next_of_recording(now);
  return credit_ == 0 || waiting_.empty() ? nullptr : waiting_.take();
}

std::optional<Message> PageClient::next(Clock::time_point now) {
  if (auto text = next_text(now)) return text;
  const SharedSweep sweep = next_sweep(now);
  if (!sweep) return next_text(now);
  --credit_;
  return Message{false, write_sweep_head(*sweep, now), sweep->frame};
}

std::optional<Clock::time_point> PageClient::due(Clock::time_point now) {
  return player_ ? player_->next_change(now) : std::nullopt;
}

}  // namespace sweepcast::view
