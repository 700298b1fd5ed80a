// SPDX-License-Identifier: MIT
#include "generator/support/reserved_names.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace contactspline {
namespace {

// The lists are text, with a blank or a line end between two names.
constexpr std::string_view kKeywordsOfCpp = R"(
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class
compl concept const const_cast consteval constexpr constinit continue co_await co_return co_yield decltype
default delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int
long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register
reinterpret_cast requires return short signed sizeof static static_assert static_cast struct switch template
this thread_local throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t
while xor xor_eq
)";

constexpr std::string_view kKeywordsOfFaust = R"(
abs acos any asin assertbounds atan atan2 attach button case ceil checkbox component control cos declare
doubleprecision enable environment exp fconstant ffunction fixedpointprecision float floor fmod fvariable
hbargraph hgroup highest hslider import inputs int letrec library log log10 lowest max mem min nentry ondemand
outputs par pow prefix process prod quadprecision rdtable remainder rint round route rwtable select2 select3 seq
sin singleprecision soundfile sqrt sum tan tgroup vbargraph vgroup vslider waveform where with xor
)";

// A struct of such a name hides the namespace behind a using-declaration.
constexpr std::string_view kNamespaces = R"(
std contactspline
)";

// Files that Faust programs import: those of its own libraries and of this project.
constexpr std::string_view kLibrariesOfFaust = R"(
aanl all analyzers basics compressors contactspline contactspline_instruments contactspline_modal debug delays
demos doc dx7 effect env envelopes fds filter filters hoa hysteresis instruments interpolators lfo linearalgebra
math maths maxmsp mi misceffects motion music noises operator oscillator oscillators phaflangers physmodels
pitchenv platform quantizers reducemaps reverbs routes sf signals soundfiles spats stdfaust synths tonestacks
tubes vaeffects version wdmodels webaudio
)";

// Lower-case macros of the headers of C++, of the C library of Debian 12, of Windows and macOS.
constexpr std::string_view kMacros = R"(
alloca arp_hln arp_hrd arp_op arp_pln arp_pro assert assert_perror b64_ntop b64_pton basename be16toh be32toh
be64toh bswap_16 bswap_32 bswap_64 btodb cdecl check clrbit complex d_fileno dbtob direct dn_count_labels
dq_bhardlimit dq_bsoftlimit dq_btime dq_curinodes dq_curspace dq_ihardlimit dq_isoftlimit dq_itime dq_valid
dqoff errno far fp_nquery fp_query fp_resstat fs_to_dq_blocks h_addr h_errno hostalias howmany htobe16 htobe32
htobe64 htole16 htole32 htole64 huge hyper i386 icmp6_data16 icmp6_data32 icmp6_data8 icmp6_id icmp6_maxdelay
icmp6_mtu icmp6_pptr icmp6_seq icmp_data icmp_gwaddr icmp_id icmp_ip icmp_lifetime icmp_mask icmp_nextmtu
icmp_num_addrs icmp_otime icmp_pmvoid icmp_pptr icmp_radv icmp_rtime icmp_seq icmp_ttime icmp_void icmp_wpa
ifa_broadaddr ifa_dstaddr ifc_buf ifc_req ifr_addr ifr_bandwidth ifr_broadaddr ifr_data ifr_dstaddr ifr_flags
ifr_hwaddr ifr_ifindex ifr_map ifr_metric ifr_mtu ifr_name ifr_netmask ifr_newname ifr_qlen ifr_slave imaginary
interface ip6_flow ip6_hlim ip6_hops ip6_nxt ip6_plen ip6_vfc isalnum_l isalpha_l isascii isascii_l isblank_l
isclr iscntrl_l isdigit_l isgraph_l islower_l isprint_l ispunct_l isset isspace_l issubnormal isupper_l
isxdigit_l le16toh le32toh le64toh linux loc_aton loc_ntoa major makedev math_errhandling max min minor
mld_cksum mld_code mld_maxdelay mld_reserved mld_type msg_cbytes nd_na_cksum nd_na_code nd_na_flags_reserved
nd_na_type nd_ns_cksum nd_ns_code nd_ns_reserved nd_ns_type nd_ra_cksum nd_ra_code nd_ra_curhoplimit
nd_ra_flags_reserved nd_ra_router_lifetime nd_ra_type nd_rd_cksum nd_rd_code nd_rd_reserved nd_rd_type
nd_rs_cksum nd_rs_code nd_rs_reserved nd_rs_type near nil no_argument ns_msg_base ns_msg_count ns_msg_end
ns_msg_id ns_msg_size ns_rr_class ns_rr_name ns_rr_rdata ns_rr_rdlen ns_rr_ttl ns_rr_type nsaddr obstack_1grow
obstack_1grow_fast obstack_alignment_mask obstack_alloc obstack_base obstack_begin obstack_blank
obstack_blank_fast obstack_chunk_size obstack_chunkfun obstack_copy obstack_copy0 obstack_empty_p obstack_finish
obstack_free obstack_freefun obstack_grow obstack_grow0 obstack_init obstack_int_grow obstack_int_grow_fast
obstack_make_room obstack_memory_used obstack_next_free obstack_object_size obstack_ptr_grow
obstack_ptr_grow_fast obstack_room obstack_specify_allocation obstack_specify_allocation_with_arg offsetof
optional_argument p_cdname p_cdnname p_class p_fqname p_fqnname p_option p_query p_rcode p_time p_type pascal
powerof2 pthread_cleanup_pop pthread_cleanup_pop_restore_np pthread_cleanup_push pthread_cleanup_push_defer_np
putlong putshort require required_argument res_close res_hostalias res_init res_isourserver res_nameinquery
res_nclose res_ninit res_queriesmatch res_randomid rip_nets rip_tracefile roundup rr_cksum rr_code rr_seqnum
rr_type rt_mss s6_addr s6_addr16 s6_addr32 sa_handler sa_sigaction sax25_uid sched_priority setbit setjmp
si_addr si_addr_lsb si_arch si_band si_call_addr si_fd si_int si_lower si_overrun si_pid si_pkey si_ptr
si_status si_stime si_syscall si_timerid si_uid si_upper si_utime si_value sigev_notify_attributes
sigev_notify_function sigmask sigsetjmp sipx_action sipx_special small ss_name ss_speed st_atime st_ctime
st_mtime stats_ptr stderr stdin stdout strdupa strndupa sym_ntop sym_ntos sym_ston td_event_addset
td_event_delset td_event_emptyset td_event_fillset td_eventisempty td_eventismember th_block th_code th_data
th_msg th_stuff timeradd timerclear timercmp timerisset timersub toascii toascii_l tsp_hopcnt tsp_time unix
ut_addr ut_name ut_time ut_xtime va_arg va_copy va_end va_start verify
)";

constexpr std::array kLists = {kKeywordsOfCpp, kKeywordsOfFaust, kNamespaces, kLibrariesOfFaust, kMacros};

bool has(std::string_view list, std::string_view name) {
  const auto is_border = [](char c) { return c == ' ' || c == '\n'; };
  for (auto at = list.find(name); at != list.npos; at = list.find(name, at + 1))
    if (is_border(list[at - 1]) && is_border(list[at + name.size()])) return true;
  return false;
}

}  // namespace

bool is_reserved_name(std::string_view name) {
  return std::ranges::any_of(kLists, [&](std::string_view list) { return has(list, name); });
}

}  // namespace contactspline
