#include "codec/beam/point_schedule.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

namespace sweepcast::beam {
namespace {

// The items of an order that are cells, as rows and columns.
struct Visit {
  std::uint32_t row, col;
};
std::vector<Visit> visits_of(const PointOrder& order, std::uint32_t cells, std::uint32_t cols) {
  std::vector<Visit> visits;
  for (const std::uint32_t item : order.items) {
    if (item < cells) visits.push_back({item / cols, item % cols});
  }
  return visits;
}

// Whether columns fall along the rows more often than they rise.
bool runs_backwards(std::span<const Visit> visits, std::uint32_t rows, std::uint32_t cols) {
  std::vector<std::uint32_t> last(rows, cols);
  std::int64_t balance = 0;
  for (const Visit& visit : visits) {
    if (last[visit.row] != cols) {
      const std::uint32_t onward = (visit.col + cols - last[visit.row]) % cols;
      balance += 2 * onward < cols ? 1 : -1;
    }
    last[visit.row] = visit.col;
  }
  return balance < 0;
}

// Rows sorted by a key of each.
template <class Key>
std::vector<std::uint32_t> rows_by(const std::vector<Key>& keys) {
  std::vector<std::uint32_t> rows(keys.size());
  std::iota(rows.begin(), rows.end(), 0U);
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
  return rows;
}

// Rows in the order in which they first occur; each begins where it first occurs.
Schedule ring_schedule(std::span<const Visit> visits, std::uint32_t rows, bool backwards) {
  Schedule schedule{true, backwards, {}, std::vector<std::uint32_t>(rows, 0)};
  std::vector<std::size_t> first(rows, visits.size());
  for (std::size_t i = visits.size(); i-- > 0;) {
    first[visits[i].row] = i;
    schedule.first_column[visits[i].row] = visits[i].col;
  }
  schedule.rows = rows_by(first);
  return schedule;
}

// Where a point stood when the fullest row had come last.
struct Vote {
  std::uint32_t offset;  // columns from that row's point
  std::uint32_t place;   // points after it
};

// Mean place of the middle half, 1/65536: missing points shift places, strays spoil them.
std::uint64_t middle_mean(std::span<const Vote> votes) {
  const std::size_t begin = votes.size() / 4;
  const std::size_t end = votes.size() - begin;
  std::uint64_t sum = 0;
  for (const Vote& vote : votes.subspan(begin, end - begin)) sum += vote.place;
  return (sum << 16) / (end - begin);
}

// A firing is what lies between two points of the fullest row. The others stand in it where, and
// as many columns off, as they mostly do.
Schedule firing_schedule(std::span<const Visit> visits, std::uint32_t rows, std::uint32_t cols,
                         bool backwards) {
  std::vector<std::size_t> count(rows, 0);
  for (const Visit& visit : visits) ++count[visit.row];
  const auto reference =
      static_cast<std::uint32_t>(std::max_element(count.begin(), count.end()) - count.begin());
  std::vector<std::vector<Vote>> votes(rows);
  std::optional<std::uint32_t> column;  // of the reference's last point
  std::uint32_t start = visits.front().col;
  std::uint32_t place = 0;
  for (const Visit& visit : visits) {
    if (visit.row == reference) {
      if (!column) start = visit.col;
      column = visit.col;
      place = 0;
    } else if (column) {
      votes[visit.row].push_back({(visit.col + cols - *column) % cols, ++place});
    }
  }
  Schedule schedule{false, backwards, {}, std::vector<std::uint32_t>(rows, 0)};
  std::vector<std::uint64_t> places(rows, 0);
  for (std::uint32_t row = 0; row < rows; ++row) {
    std::vector<Vote>& of_row = votes[row];
    std::uint32_t offset = 0;
    std::size_t most = 0;
    std::sort(of_row.begin(), of_row.end(), [](const Vote& a, const Vote& b) {
      return std::pair{a.offset, a.place} < std::pair{b.offset, b.place};
    });
    for (std::size_t i = 0, end = 0; i < of_row.size(); i = end) {
      while (end < of_row.size() && of_row[end].offset == of_row[i].offset) ++end;
      if (end - i <= most) continue;
      most = end - i;
      offset = of_row[i].offset;
      places[row] = middle_mean(std::span(of_row).subspan(i, most));
    }
    // The first points may come before the reference's first.
    const std::uint32_t before = backwards ? 1 : cols - 1;
    schedule.first_column[row] = (start + offset + before) % cols;
  }
  schedule.rows = rows_by(places);
  return schedule;
}

// How many visits are followed by that which the schedule lets expect.
std::size_t foreseen(const Schedule& schedule, std::span<const Visit> visits, std::uint32_t cols) {
  const std::vector<std::uint32_t> cells = cells_in_order(schedule, cols);
  std::vector<std::uint32_t> next(cells.size() + 1, 0);
  std::vector<bool> occupied(cells.size(), false);
  for (const Visit& visit : visits) occupied[visit.row * cols + visit.col] = true;
  std::uint32_t after = static_cast<std::uint32_t>(cells.size());
  for (std::size_t i = cells.size(); i-- > 0;) {
    if (!occupied[cells[i]]) continue;
    next[cells[i]] = after;
    after = cells[i];
  }
  std::size_t hits = 0;
  for (std::size_t i = 0; i + 1 < visits.size(); ++i) {
    const std::uint32_t here = visits[i].row * cols + visits[i].col;
    if (next[here] == visits[i + 1].row * cols + visits[i + 1].col) ++hits;
  }
  return hits;
}

}  // namespace

std::vector<std::uint32_t> cells_in_order(const Schedule& schedule, std::uint32_t cols) {
  std::vector<std::uint32_t> cells;
  const auto rows = static_cast<std::uint32_t>(schedule.rows.size());
  cells.reserve(std::size_t{rows} * cols);
  const auto cell = [&](std::uint32_t row, std::uint32_t step) {
    const std::uint32_t onward = schedule.backwards ? cols - step : step;
    return row * cols + (schedule.first_column[row] + onward) % cols;
  };
  if (schedule.by_ring) {
    for (const std::uint32_t row : schedule.rows) {
      for (std::uint32_t step = 0; step < cols; ++step) cells.push_back(cell(row, step));
    }
  } else {
    for (std::uint32_t step = 0; step < cols; ++step) {
      for (const std::uint32_t row : schedule.rows) cells.push_back(cell(row, step));
    }
  }
  return cells;
}

Schedule schedule_of(const PointOrder& order, const BeamImage& image) {
  const auto rows = static_cast<std::uint32_t>(image.rows);
  const auto cols = static_cast<std::uint32_t>(image.cols);
  const std::vector<Visit> visits = visits_of(order, rows * cols, cols);
  const bool backwards = runs_backwards(visits, rows, cols);
  Schedule by_ring = ring_schedule(visits, rows, backwards);
  if (visits.empty()) return by_ring;
  Schedule by_firing = firing_schedule(visits, rows, cols, backwards);
  const bool ring_wins = foreseen(by_ring, visits, cols) >= foreseen(by_firing, visits, cols);
  return ring_wins ? by_ring : by_firing;
}

void write_schedule(const Schedule& schedule, ByteWriter& out) {
  out.put(static_cast<std::uint8_t>((schedule.by_ring ? 1 : 0) + (schedule.backwards ? 2 : 0)));
  for (const std::uint32_t row : schedule.rows) {
    out.put_varint(row);
    out.put_varint(schedule.first_column[row]);
  }
}

bool read_schedule(ByteReader& in, std::uint32_t rows, std::uint32_t cols, Schedule& schedule) {
  const auto flags = in.get<std::uint8_t>();
  schedule = {(flags & 1) != 0, (flags & 2) != 0, {}, std::vector<std::uint32_t>(rows, cols)};
  for (std::uint32_t i = 0; i < rows; ++i) {
    const auto row = static_cast<std::uint32_t>(in.get_varint(rows - 1));
    const auto column = static_cast<std::uint32_t>(in.get_varint(cols - 1));
    if (!in.ok() || schedule.first_column[row] != cols) return false;  // a row comes once
    schedule.rows.push_back(row);
    schedule.first_column[row] = column;
  }
  return in.ok();
}

}  // namespace sweepcast::beam
