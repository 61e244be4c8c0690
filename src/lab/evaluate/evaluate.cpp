#include "lab/evaluate/evaluate.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

namespace sweepcast::lab {
namespace {

using nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

ordered_json to_json(const Coding& coding) {
  return {{"ratio", coding.ratio},         {"bytes", coding.bytes}, {"encode_ms", coding.encode_ms},
          {"decode_ms", coding.decode_ms}, {"parts", coding.parts}, {"picture", coding.picture}};
}

/// Throws nlohmann's exceptions where the value is of another form.
Coding coding_of(const ordered_json& value) {
  Coding coding;
  coding.ratio = value.at("ratio");
  coding.bytes = value.at("bytes");
  coding.encode_ms = value.at("encode_ms");
  coding.decode_ms = value.at("decode_ms");
  coding.parts = value.at("parts").get<std::map<std::string, double>>();
  coding.picture = value.at("picture");
  return coding;
}

ordered_json to_json(const Figures& figures) {
  ordered_json value = ordered_json::array();  // NaN and infinite numbers become null
  for (const Figure& figure : figures) value.push_back({figure.name, figure.value});
  return value;
}

Figures figures_of(const ordered_json& value) {
  Figures figures;
  for (const ordered_json& pair : value) {
    const ordered_json& number = pair.at(1);
    figures.push_back({pair.at(0), number.is_null() ? kNone : number.get<double>()});
  }
  return figures;
}

/// A codec at one setting: what is known of it, and what is still to be measured.
struct Job {
  Peer* peer = nullptr;
  std::optional<Coding> coding;
  std::vector<std::optional<Figures>> figures;  ///< of each task

  [[nodiscard]] bool is_done() const {
    return coding && std::all_of(figures.begin(), figures.end(),
                                 [](const auto& figure) { return figure.has_value(); });
  }
};

class Evaluator {
 public:
  Evaluator(const DriveFiles& drive, const Tasks& tasks, const ResultCache& cache,
            const EvaluateOptions& options)
      : drive_(drive), tasks_(tasks), cache_(cache), options_(options) {}

  Result<Evaluation> run(const Peers& peers) {
    for (const auto& peer : peers) jobs_.push_back(known(*peer));
    std::vector<Job*> open;
    for (Job& job : jobs_) {
      if (!job.is_done()) open.push_back(&job);
    }
    total_ = open.size() * drive_.sweeps.size();
    if (!open.empty()) work_off(open);
    if (error_) return tl::unexpected(std::move(*error_));
    for (const Job& job : jobs_) {
      if (job.coding) result_.rows.push_back(row_of(job));
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::string key(const Peer& peer, std::string_view what) const {
    return fmt::format("version {}; sweeps {}; codec {}; setting {}; {}", options_.version,
                       drive_.sweeps_hash, peer.codec(), peer.setting(), what);
  }
  [[nodiscard]] std::string key(const Peer& peer, const Task& task) const {
    return key(peer, fmt::format("task {}: {}", task.name(), task.key()));
  }

  /// What an earlier run has left, through `parse`; nothing where it is absent or damaged.
  template <class Parse>
  auto earlier(const std::string& key, Parse parse)
      -> std::optional<decltype(parse(ordered_json()))> {
    ordered_json value;
    if (options_.fresh) return std::nullopt;
    const ResultCache::State state = cache_.load(key, value);
    if (state == ResultCache::State::found) {
      try {
        auto result = parse(value);
        ++result_.kept;
        return result;
      } catch (const nlohmann::json::exception&) {  // of another form: measured again
      }
    }
    if (state != ResultCache::State::absent) ++result_.damaged;
    return std::nullopt;
  }

  Job known(Peer& peer) {
    Job job{&peer, earlier(key(peer, "coding"), coding_of), {}};
    for (const auto& task : tasks_) {
      job.figures.push_back(earlier(key(peer, *task), figures_of));
    }
    return job;
  }

  void work_off(const std::vector<Job*>& open) {
    step({});
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    const std::size_t wanted =
        options_.threads > 0 ? static_cast<std::size_t>(options_.threads) : cores;
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < std::min(wanted, open.size()); ++i) {
      threads.emplace_back([&] {
        while (!stop_) {
          const std::size_t next = next_++;
          if (next >= open.size()) return;
          work(*open[next]);
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  }

  void work(Job& job) {
    std::vector<const Task*> tasks;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      if (job.figures[i]) continue;
      tasks.push_back(tasks_[i].get());
      places.push_back(i);
    }
    const std::string name = label(*job.peer);
    auto measured = measure(drive_, *job.peer, tasks, [&] { step(name); });
    const std::scoped_lock lock(mutex_);
    if (!measured) {
      result_.failures.push_back({measured.error().code, name + ": " + measured.error().message});
      return;
    }
    if (!job.coding) {
      job.coding = std::move(measured->coding);
      keep(key(*job.peer, "coding"), to_json(*job.coding));
    }
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      TaskOutcome& outcome = measured->outcomes[i];
      if (!outcome) {
        result_.failures.push_back(
            {outcome.error().code,
             fmt::format("{}, {}: {}", name, tasks[i]->name(), outcome.error().message)});
        continue;
      }
      keep(key(*job.peer, *tasks[i]), to_json(*outcome));
      job.figures[places[i]] = std::move(*outcome);
    }
  }

  /// With the lock held.
  void keep(const std::string& key, const ordered_json& value) {
    ++result_.measured;
    if (Status stored = cache_.store(key, value); !stored && !error_) {
      error_ = std::move(stored.error());
      stop_ = true;
    }
  }

  void step(std::string_view what) {
    const std::scoped_lock lock(mutex_);
    if (options_.on_progress) options_.on_progress(done_, total_, what);
    ++done_;
  }

  static std::string label(const Peer& peer) {
    return peer.setting().empty() ? peer.codec() : peer.codec() + " " + peer.setting();
  }

  static EvaluationRow row_of(const Job& job) {
    EvaluationRow row{job.peer->codec(), job.peer->setting(), *job.coding, {}};
    for (const auto& figures : job.figures) {
      if (figures) std::copy(figures->begin(), figures->end(), std::back_inserter(row.figures));
    }
    return row;
  }

  const DriveFiles& drive_;
  const Tasks& tasks_;
  const ResultCache& cache_;
  const EvaluateOptions& options_;
  std::vector<Job> jobs_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;  ///< guards what follows
  Evaluation result_;
  std::optional<Error> error_;
  std::size_t done_ = 0;
  std::size_t total_ = 0;
};

}  // namespace

double EvaluationRow::figure(std::string_view name) const {
  const auto found =
      std::find_if(figures.begin(), figures.end(), [&](const Figure& f) { return f.name == name; });
  return found == figures.end() ? kNone : found->value;
}

Result<Evaluation> evaluate(const DriveFiles& drive, const Peers& peers, const Tasks& tasks,
                            const ResultCache& cache, const EvaluateOptions& options) {
  return Evaluator(drive, tasks, cache, options).run(peers);
}

}  // namespace sweepcast::lab
