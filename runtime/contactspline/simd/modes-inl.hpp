// SPDX-License-Identifier: MIT
// The modes of a resonator in vectors, alone: a part of kernels-inl.hpp (docs/how-it-works/kernels.md).

template <typename T>
using Tag = hn::ScalableTag<T>;
template <typename T>
using Vector = hn::Vec<Tag<T>>;
/// A lane for each of some voices: half a vector of 512 bits, so that there are two vectors to work on by turns.
template <typename T>
using VoiceTag = std::remove_cv_t<decltype(hn::CappedTag<T, 32 / sizeof(T)>())>;
template <typename T>
using VoiceVector = hn::Vec<VoiceTag<T>>;

/// Is the rest of the stiffness kept beside it, because T rounds it? As in ModalBank.
template <typename T>
constexpr bool kRounds = sizeof(T) < sizeof(double);

/// The loss of a mode, plus the rest of its stiffness where that is kept (see move).
template <typename T>
HWY_INLINE Vector<T> loss_with(Vector<T> rest, Vector<T> loss) {
  return kRounds<T> ? hn::Add(loss, rest) : loss;
}

/// One sample of a mode without force: its change c is damping_gain times its free increment d. Does what
/// ModalBank::commit does, and sums the pull in the order in which its parts are known. loss: loss_with(rest, loss).
template <bool kDamped, typename T>
HWY_INLINE void move(Vector<T> stiffness, Vector<T> rest, Vector<T> loss, Vector<T> damping_gain, Vector<T>& q,
                     Vector<T>& d) {
  const auto c = kDamped ? hn::Mul(damping_gain, d) : d;
  const auto q_before = q;
  q = hn::Add(q, c);
  if constexpr (kRounds<T>) {
    const auto pull = hn::MulAdd(stiffness, q, hn::MulAdd(loss, c, hn::Mul(rest, q_before)));
    d = kDamped ? hn::Add(hn::Sub(c, d), hn::Sub(c, pull)) : hn::Sub(c, pull);
  } else {
    const auto kept = hn::NegMulAdd(stiffness, q, hn::NegMulAdd(loss, c, c));
    d = kDamped ? hn::Add(hn::Sub(c, d), kept) : kept;
  }
}

/// One sample on a bridge: the modes follow half its change, advance, and follow the other half (ModalBank::shift).
HWY_INLINE BridgeForces<Sample> advance_on_bridge_here(std::span<const StringsOnBridge<Sample>> strings,
                                                       Sample change) {
  const Tag<Sample> tag;
  const auto half = hn::Set(tag, change / 2);
  auto all = hn::Zero(tag), output = all;
  for (const auto& [modes, shape, rest, damping_gain, weight] : strings) {
    auto force = hn::Zero(tag);
    const auto gain = hn::Set(tag, damping_gain);
    for (std::size_t i = 0; i < modes.modes; i += hn::Lanes(tag)) {
      const auto stiffness = hn::Load(tag, modes.stiffness + i);
      const auto by = hn::Mul(hn::Load(tag, rest + i), half);
      const auto d = hn::MulAdd(stiffness, by, hn::Load(tag, modes.free_increment + i));
      const auto c = hn::Mul(gain, d), q = hn::Add(hn::Sub(hn::Load(tag, modes.displacement + i), by), c);
      auto pull = hn::MulAdd(stiffness, hn::Sub(q, by), hn::Mul(hn::Load(tag, modes.loss + i), c));
      if constexpr (kRounds<Sample>) pull = hn::MulAdd(hn::Load(tag, modes.stiffness_rest + i), q, pull);
      const auto followed = hn::Sub(q, by);
      hn::Store(followed, tag, modes.displacement + i);
      hn::Store(hn::Add(hn::Sub(c, d), hn::Sub(c, pull)), tag, modes.free_increment + i);
      force = hn::MulAdd(hn::Load(tag, shape + i), followed, force);
    }
    all = hn::Add(all, force);
    output = hn::MulAdd(hn::Set(tag, weight), force, output);
  }
  return {hn::GetLane(hn::SumOfLanes(tag, all)), hn::GetLane(hn::SumOfLanes(tag, output))};
}

HWY_INLINE Sample inner_product_here(std::size_t modes, const Sample* a, const Sample* b) {
  const Tag<Sample> tag;
  const std::size_t lanes = hn::Lanes(tag);
  auto even = hn::Zero(tag), odd = even;
  std::size_t i = 0;
  for (; i + 2 * lanes <= modes; i += 2 * lanes) {
    even = hn::MulAdd(hn::Load(tag, a + i), hn::Load(tag, b + i), even);
    odd = hn::MulAdd(hn::Load(tag, a + i + lanes), hn::Load(tag, b + i + lanes), odd);
  }
  for (; i < modes; i += lanes) even = hn::MulAdd(hn::Load(tag, a + i), hn::Load(tag, b + i), even);
  return hn::GetLane(hn::SumOfLanes(tag, hn::Add(even, odd)));
}

/// Writes to sums[0] the sum of a[i] a[first + i], to sums[1] that of a[i] a[first + shift + i], and so on.
template <std::size_t kCount, typename T>
HWY_INLINE void sum_some_shifted_products(std::size_t count, const T* a, std::size_t first, std::size_t shift,
                                          T* sums) {
  const Tag<T> tag;
  Vector<T> parts[kCount];
  for (std::size_t k = 0; k < kCount; ++k) parts[k] = hn::Zero(tag);
  for (std::size_t i = 0; i < count; i += hn::Lanes(tag)) {
    const auto v = hn::Load(tag, a + i);
    for (std::size_t k = 0; k < kCount; ++k)
      parts[k] = hn::MulAdd(v, hn::LoadU(tag, a + i + first + k * shift), parts[k]);
  }
  for (std::size_t k = 0; k < kCount; ++k) sums[k] = hn::GetLane(hn::SumOfLanes(tag, parts[k]));
}

HWY_INLINE void sum_shifted_products_here(std::size_t count, const Sample* factors, const Sample* values,
                                          Sample* products, std::size_t shift, std::span<Sample> sums) {
  const Tag<Sample> tag;
  for (std::size_t i = 0; i < count; i += hn::Lanes(tag))
    hn::Store(hn::Mul(hn::Load(tag, factors + i), hn::Load(tag, values + i)), tag, products + i);
  std::size_t k = 0;
  for (; k + 4 <= sums.size(); k += 4)
    sum_some_shifted_products<4>(count, products, k * shift, shift, sums.data() + k);
  if (k + 2 <= sums.size()) sum_some_shifted_products<2>(count, products, k * shift, shift, sums.data() + k), k += 2;
  if (k < sums.size()) sum_some_shifted_products<1>(count, products, k * shift, shift, sums.data() + k);
}

/// Sums of kCount rows times a vector of modes.
template <std::size_t kCount, typename T>
HWY_INLINE void sum_rows(std::size_t modes, const T* vector, const T* const* rows, T* sums) {
  const Tag<T> tag;
  Vector<T> parts[kCount];
  for (std::size_t p = 0; p < kCount; ++p) parts[p] = hn::Zero(tag);
  for (std::size_t i = 0; i < modes; i += hn::Lanes(tag)) {
    const auto v = hn::Load(tag, vector + i);
    for (std::size_t p = 0; p < kCount; ++p) parts[p] = hn::MulAdd(v, hn::Load(tag, rows[p] + i), parts[p]);
  }
  for (std::size_t p = 0; p < kCount; ++p) sums[p] = hn::GetLane(hn::SumOfLanes(tag, parts[p]));
}

/// The same for any number of rows: eight at a time, so that as many sums run side by side.
template <typename T>
HWY_INLINE void sum_all_rows(std::size_t modes, const T* vector, std::span<const T* const> rows, T* sums) {
  std::size_t p = 0;
  for (; p + 8 <= rows.size(); p += 8) sum_rows<8>(modes, vector, rows.data() + p, sums + p);
  if (p + 4 <= rows.size()) sum_rows<4>(modes, vector, rows.data() + p, sums + p), p += 4;
  if (p + 2 <= rows.size()) sum_rows<2>(modes, vector, rows.data() + p, sums + p), p += 2;
  if (p < rows.size()) sum_rows<1>(modes, vector, rows.data() + p, sums + p);
}

HWY_INLINE Sample sum_free_increments_here(std::size_t modes, const Sample* free_increment,
                                           std::span<const Sample* const> at, Sample* increments) {
  const Tag<Sample> tag;
  auto travel = hn::Zero(tag);
  for (std::size_t i = 0; i < modes; i += hn::Lanes(tag))
    travel = hn::Add(travel, hn::Abs(hn::Load(tag, free_increment + i)));
  sum_all_rows(modes, free_increment, at, increments);
  return hn::GetLane(hn::SumOfLanes(tag, travel));
}

/// One sample under forces: the change of a mode is damping_gain times (free increment + receptance sum of shape
/// force). Sums the first kRows rows of `at` on the way. The arrays are copied pointers, so that stores do not make
/// the compiler load them again.
template <std::size_t kRows, typename T>
HWY_INLINE T advance_and_sum(const ModalArrays<T> modes, T damping_gain, std::span<const T* const> pushed,
                             const T* forces, const T* const* at, T* increments) {
  const Tag<T> tag;
  const auto gain = hn::Set(tag, damping_gain);
  auto travel = hn::Zero(tag);
  const T* rows[kRows + 1] = {};
  Vector<T> parts[kRows + 1];
  for (std::size_t p = 0; p < kRows; ++p) rows[p] = at[p], parts[p] = hn::Zero(tag);
  const std::size_t pushes = pushed.size();
  const T* const first = pushes > 0 ? pushed[0] : modes.receptance;
  const auto first_force = hn::Set(tag, pushes > 0 ? forces[0] : T(0));
  for (std::size_t i = 0; i < modes.modes; i += hn::Lanes(tag)) {
    const auto d = hn::Load(tag, modes.free_increment + i), loss = hn::Load(tag, modes.loss + i);
    auto force = hn::Mul(first_force, hn::Load(tag, first + i));
    for (std::size_t p = 1; p < pushes; ++p)
      force = hn::MulAdd(hn::Set(tag, forces[p]), hn::Load(tag, pushed[p] + i), force);
    const auto c = hn::Mul(gain, hn::MulAdd(hn::Load(tag, modes.receptance + i), force, d));
    const auto q = hn::Add(hn::Load(tag, modes.displacement + i), c);
    auto pull = hn::MulAdd(hn::Load(tag, modes.stiffness + i), q, hn::Mul(loss, c));
    if constexpr (kRounds<T>) pull = hn::MulAdd(hn::Load(tag, modes.stiffness_rest + i), q, pull);
    const auto next = hn::Add(hn::Sub(c, d), hn::Sub(c, pull));
    hn::Store(c, tag, modes.change + i);
    hn::Store(q, tag, modes.displacement + i);
    hn::Store(next, tag, modes.free_increment + i);
    travel = hn::Add(travel, hn::Abs(next));
    for (std::size_t p = 0; p < kRows; ++p) parts[p] = hn::MulAdd(next, hn::Load(tag, rows[p] + i), parts[p]);
  }
  for (std::size_t p = 0; p < kRows; ++p) increments[p] = hn::GetLane(hn::SumOfLanes(tag, parts[p]));
  return hn::GetLane(hn::SumOfLanes(tag, travel));
}

HWY_INLINE Sample advance_under_forces_here(const ModalArrays<Sample>& modes, Sample damping_gain,
                                            std::span<const Sample* const> pushed, const Sample* forces,
                                            std::span<const Sample* const> at, Sample* increments) {
  const auto advance = [&](auto rows) HWY_ATTR {
    return advance_and_sum<rows>(modes, damping_gain, pushed, forces, at.data(), increments);
  };
  switch (at.size()) {
    case 0:
      return advance(std::integral_constant<std::size_t, 0>());
    case 1:
      return advance(std::integral_constant<std::size_t, 1>());
    case 2:
      return advance(std::integral_constant<std::size_t, 2>());
    case 3:
      return advance(std::integral_constant<std::size_t, 3>());
    default:
      break;
  }
  const Sample travel = advance(std::integral_constant<std::size_t, 4>());
  sum_all_rows<Sample>(modes.modes, modes.free_increment, at.subspan(4), increments + 4);
  return travel;
}

/// All in one pass. The arrays are copied pointers, as in advance_and_sum.
HWY_INLINE void advance_stretching_here(const ModalArrays<Sample>& arrays, const SquareForm<Sample>& of_form,
                                        Sample* sums) {
  const Tag<Sample> tag;
  const ModalArrays<Sample> modes = arrays;
  const SquareForm<Sample> form = of_form;
  const auto moved_by = hn::Set(tag, form.moved_by);
  auto by_q = hn::Zero(tag), by_d = by_q, by_c = by_q, by_motion = by_q;
  for (std::size_t i = 0; i < modes.modes; i += hn::Lanes(tag)) {
    const auto c = hn::MulAdd(moved_by, hn::Load(tag, form.motion + i), hn::Load(tag, modes.change + i));
    const auto q = hn::Add(hn::Load(tag, modes.displacement + i), c);
    auto pull = hn::MulAdd(hn::Load(tag, modes.stiffness + i), q, hn::Mul(hn::Load(tag, modes.loss + i), c));
    if constexpr (kRounds<Sample>) pull = hn::MulAdd(hn::Load(tag, modes.stiffness_rest + i), q, pull);
    const auto d = hn::Sub(c, pull), gradient = hn::Mul(hn::Load(tag, form.squares + i), q);
    const auto motion = hn::Mul(hn::Load(tag, modes.receptance + i), gradient);
    hn::Store(c, tag, modes.change + i);
    hn::Store(q, tag, modes.displacement + i);
    hn::Store(d, tag, modes.free_increment + i);
    hn::Store(motion, tag, form.motion + i);
    by_q = hn::MulAdd(gradient, q, by_q);
    by_d = hn::MulAdd(gradient, d, by_d);
    by_c = hn::MulAdd(gradient, c, by_c);
    by_motion = hn::MulAdd(gradient, motion, by_motion);
  }
  sums[0] = hn::GetLane(hn::SumOfLanes(tag, by_q));
  sums[1] = hn::GetLane(hn::SumOfLanes(tag, by_d));
  sums[2] = hn::GetLane(hn::SumOfLanes(tag, by_c));
  sums[3] = hn::GetLane(hn::SumOfLanes(tag, by_motion));
}

/// In as many vectors as kRowsTogether rows fill.
HWY_INLINE void multiply_form_here(const FormBlocks<Sample>& matrix, const Sample* q, Sample* product) {
  const hn::CappedTag<Sample, kRowsTogether> tag;
  constexpr std::size_t kLanes = hn::MaxLanes(tag), kVectors = kRowsTogether / kLanes;
  using Sums = hn::Vec<decltype(tag)>;
  const FormColumns* run = matrix.runs;
  const Sample* factor = matrix.factors;
  for (const FormRows& rows : matrix.rows) {
    Sums sums[kVectors];
    for (Sums& sum : sums) sum = hn::Zero(tag);
    for (const FormColumns* const end = run + rows.runs; run != end; ++run)
      for (std::size_t j = run->first; j < run->first + run->count; ++j, factor += kRowsTogether)
        for (std::size_t v = 0; v < kVectors; ++v)
          sums[v] = hn::MulAdd(hn::Load(tag, factor + v * kLanes), hn::Set(tag, q[j]), sums[v]);
    HWY_ALIGN Sample stored[kRowsTogether];
    for (std::size_t v = 0; v < kVectors; ++v) hn::Store(sums[v], tag, stored + v * kLanes);
    for (std::size_t r = 0; r < rows.count; ++r) product[rows.first + r] = stored[r];
  }
}

/// As portable::retune, where vectors hold double precision.
#if HWY_HAVE_FLOAT64
HWY_INLINE void retune_here(RetunedModes& m) {
  const Tag<double> tag;
  const auto one = hn::Set(tag, 1.0), half = hn::Set(tag, 0.5), four = hn::Set(tag, 4.0);
  const auto dt = hn::Set(tag, m.time_step_s);
  for (std::size_t i = 0; i < m.modes; i += hn::Lanes(tag)) {
    const auto w = hn::Load(tag, m.angular_frequency_rad_per_s + i), decay = hn::Load(tag, m.decay_per_s + i);
    const auto loss = hn::Load(tag, m.loss + i), q = hn::Load(tag, m.displacement + i);
    const auto before = hn::Mul(half, hn::Add(loss, hn::Load(tag, m.stiffness + i)));
    const auto velocity =
        hn::Mul(hn::Load(tag, m.velocity_gain + i), hn::MulAdd(before, q, hn::Load(tag, m.free_increment + i)));
    const auto decay_factor = hn::Sqrt(hn::Sub(one, loss)), decay_loss = hn::Div(loss, hn::Add(one, decay_factor));
    const auto angle = hn::Mul(half, hn::Mul(w, dt));
    const auto sine = hn::Sin(tag, angle), cosine = hn::Cos(tag, angle);
    const auto phase_square = hn::Mul(hn::MulAdd(w, w, hn::Mul(decay, decay)), hn::Mul(dt, dt));
    const auto loss_square = hn::Mul(decay_loss, decay_loss), scale = hn::Mul(four, decay_factor);
    const auto stiffness = hn::MulAdd(scale, hn::Mul(sine, sine), loss_square);
    const auto averaging = hn::IfThenElse(hn::Gt(phase_square, hn::Zero(tag)), hn::Div(stiffness, phase_square), one);
    const auto rate =
        hn::IfThenElse(hn::Gt(w, hn::Zero(tag)), hn::Div(w, hn::Add(hn::Mul(sine, cosine), hn::Mul(sine, cosine))),
                       hn::Div(one, dt));
    const auto gain = hn::Div(rate, decay_factor);
    hn::Store(stiffness, tag, m.stiffness + i);
    hn::Store(averaging, tag, m.averaging_factor + i);
    hn::Store(hn::Div(hn::Mul(half, hn::Mul(averaging, hn::Mul(dt, dt))), hn::Load(tag, m.mass_kg + i)), tag,
              m.receptance + i);
    hn::Store(hn::MulAdd(scale, hn::Mul(cosine, cosine), loss_square), tag, m.one_plus_z_square + i);
    hn::Store(gain, tag, m.velocity_gain + i);
    hn::Store(hn::NegMulAdd(hn::Mul(half, hn::Add(loss, stiffness)), q, hn::Div(velocity, gain)), tag,
              m.free_increment + i);
  }
}
#else
HWY_INLINE void retune_here(RetunedModes& modes) {
  portable::retune(modes);
}
#endif

/// A vector of a column, 0 in the lanes up to that of the diagonal.
template <typename T>
HWY_INLINE Vector<T> below_diagonal(std::size_t diagonal, const T* column) {
  const Tag<T> tag;
  return hn::IfThenZeroElse(hn::FirstN(tag, diagonal + 1), hn::Load(tag, column));
}

/// Solves a positive definite system by a Cholesky factor. Column j of the matrix begins at matrix + j stride, on a
/// cache line; its lower triangle counts, rows from `size` to whole vectors are 0. The matrix and `right` are
/// overwritten.
HWY_INLINE void solve_positive_definite_here(std::size_t size, Sample* matrix, std::size_t stride, Sample* right) {
  const Tag<Sample> tag;
  const std::size_t lanes = hn::Lanes(tag);
  for (std::size_t j = 0; j < size; ++j) {
    Sample* column = matrix + j * stride;
    const std::size_t first = j / lanes * lanes;
    const Sample inverse = 1 / std::sqrt(std::max(column[j], Sample(1)));
    const auto scale = hn::Set(tag, inverse);
    for (std::size_t i = first; i < size; i += lanes)
      hn::Store(hn::Mul(scale, hn::Load(tag, column + i)), tag, column + i);
    const Sample solved = right[j] * inverse;
    const auto subtract = [&](std::size_t i, Vector<Sample> below) HWY_ATTR {
      hn::Store(hn::NegMulAdd(hn::Set(tag, solved), below, hn::Load(tag, right + i)), tag, right + i);
    };
    subtract(first, below_diagonal(j - first, column + first));
    for (std::size_t i = first + lanes; i < size; i += lanes) subtract(i, hn::Load(tag, column + i));
    right[j] = solved;
    column[j] = inverse;
    for (std::size_t k = j + 1; k < size; ++k) {
      Sample* next = matrix + k * stride;
      const auto factor = hn::Set(tag, column[k]);
      for (std::size_t i = k / lanes * lanes; i < size; i += lanes)
        hn::Store(hn::NegMulAdd(factor, hn::Load(tag, column + i), hn::Load(tag, next + i)), tag, next + i);
    }
  }
  for (std::size_t j = size; j-- > 0;) {
    const Sample* column = matrix + j * stride;
    std::size_t i = j / lanes * lanes;
    auto sum = hn::Mul(below_diagonal(j - i, column + i), hn::Load(tag, right + i));
    for (i += lanes; i < size; i += lanes) sum = hn::MulAdd(hn::Load(tag, column + i), hn::Load(tag, right + i), sum);
    right[j] = (right[j] - hn::GetLane(hn::SumOfLanes(tag, sum))) * column[j];
  }
}

inline constexpr std::size_t kBlock = 64;  // samples

/// Advances kVectors vectors of modes over a block of samples, in registers, and adds shape times displacement to
/// `sums`.
template <std::size_t kVectors, bool kDamped, typename T>
HWY_INLINE void advance_vectors(const ModalArrays<T>& modes, std::size_t first, T damping_gain, const T* pickup,
                                std::size_t samples, T* HWY_RESTRICT sums) {
  const Tag<T> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const auto gains = hn::Set(tag, damping_gain);
  Vector<T> stiffness[kVectors], rest[kVectors], loss[kVectors], q[kVectors], d[kVectors], shape[kVectors];
  for (std::size_t v = 0; v < kVectors; ++v) {
    const std::size_t at = first + v * lanes;
    stiffness[v] = hn::Load(tag, modes.stiffness + at);
    rest[v] = hn::Load(tag, modes.stiffness_rest + at);
    loss[v] = loss_with<T>(rest[v], hn::Load(tag, modes.loss + at));
    shape[v] = hn::Load(tag, pickup + at);
    q[v] = hn::Load(tag, modes.displacement + at);
    d[v] = hn::Load(tag, modes.free_increment + at);
  }
  for (std::size_t n = 0; n < samples; ++n) {
    auto sum = hn::Load(tag, sums + n * lanes);
    for (std::size_t v = 0; v < kVectors; ++v) {
      move<kDamped, T>(stiffness[v], rest[v], loss[v], gains, q[v], d[v]);
      sum = hn::MulAdd(shape[v], q[v], sum);
    }
    hn::Store(sum, tag, sums + n * lanes);
  }
  for (std::size_t v = 0; v < kVectors; ++v) {
    hn::Store(q[v], tag, modes.displacement + first + v * lanes);
    hn::Store(d[v], tag, modes.free_increment + first + v * lanes);
  }
}

/// Vectors advanced together: enough to hide the latency of each.
inline constexpr std::size_t kMaxVectors = 7;

template <bool kDamped, std::size_t kVectors = kMaxVectors, typename T>
HWY_INLINE void advance_group(std::size_t vectors, const ModalArrays<T>& modes, std::size_t first, T damping_gain,
                              const T* pickup, std::size_t samples, T* HWY_RESTRICT sums) {
  if (vectors == kVectors)
    return advance_vectors<kVectors, kDamped>(modes, first, damping_gain, pickup, samples, sums);
  if constexpr (kVectors > 1)
    advance_group<kDamped, kVectors - 1>(vectors, modes, first, damping_gain, pickup, samples, sums);
}

/// Sums over the lanes of each of kCount vectors, a power of two of at most the number of lanes. With as many vectors
/// as lanes, lane i holds the sum of vector i.
template <std::size_t kCount, typename D, typename T = hn::TFromD<D>>
HWY_INLINE hn::Vec<D> sums_over_lanes(D tag, const T* vectors) {
#if HWY_TARGET != HWY_SCALAR
  if constexpr (kCount > 1) {
    const auto first = sums_over_lanes<kCount / 2>(tag, vectors);
    const auto second = sums_over_lanes<kCount / 2>(tag, vectors + kCount / 2 * hn::Lanes(tag));
    return hn::Add(hn::ConcatEven(tag, second, first), hn::ConcatOdd(tag, second, first));
  }
#endif
  return hn::Load(tag, vectors);
}

template <bool kDamped, typename T>
HWY_INLINE void process_free_as(const ModalArrays<T>& modes, T damping_gain, const T* pickup, std::span<T> out) {
  const Tag<T> tag;
  const std::size_t lanes = hn::Lanes(tag);
  const std::size_t vectors = (modes.modes + lanes - 1) / lanes;
  const std::size_t groups = (vectors + kMaxVectors - 1) / kMaxVectors;
  HWY_ALIGN T sums[kBlock * HWY_MAX_BYTES / sizeof(T)];
  static_assert(kBlock % hn::MaxLanes(tag) == 0);
  while (!out.empty()) {
    const std::size_t samples = std::min(out.size(), kBlock), rounded = (samples + lanes - 1) / lanes * lanes;
    for (std::size_t i = 0; i < rounded; ++i) hn::Store(hn::Zero(tag), tag, sums + i * lanes);
    for (std::size_t group = 0, at = 0; group < groups; ++group) {
      const std::size_t count = (vectors - at + groups - group - 1) / (groups - group);
      advance_group<kDamped>(count, modes, at * lanes, damping_gain, pickup, samples, sums);
      at += count;
    }
    HWY_ALIGN T output[kBlock];
    for (std::size_t i = 0; i < samples; i += lanes)
      hn::Store(sums_over_lanes<hn::MaxLanes(tag)>(tag, sums + i * lanes), tag, output + i);
    std::copy_n(output, samples, out.data());
    out = out.subspan(samples);
  }
}

HWY_INLINE void process_free_here(const ModalArrays<Sample>& modes, Sample damping_gain, const Sample* pickup,
                                  std::span<Sample> out) {
  if (damping_gain == 1)
    process_free_as<false>(modes, damping_gain, pickup, out);
  else
    process_free_as<true>(modes, damping_gain, pickup, out);
}
