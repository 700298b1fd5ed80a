# SPDX-License-Identifier: MIT
# What the tests share; each starts in the source tree and works in a folder of its own.
set -eu
SOURCE=$PWD
cd "${AUTOPKGTEST_TMP:-$(mktemp -d)}"
# Programs say what they do on standard error, too.
exec 2>&1

# The code blocks of a page in a language: blocks PAGE LANGUAGE.
blocks() {
  awk -v begin="\`\`\`$2" '$0 == begin { on = 1; next } /^```/ { on = 0 } on' "$SOURCE/$1"
}

# Runs the commands of a section of docs/how-to/packages.md, but for those that install and those that need a sound card.
run_section() {
  sed -nE "/^## $1\$/,/^## /s/^    //p" "$SOURCE/docs/how-to/packages.md" | grep -vE '^(apt|aplay) ' >commands
  [ -s commands ] || { echo "docs/how-to/packages.md has no commands for $1"; exit 1; }
  # As root and without a screen, which sclang asks for.
  HOME=$PWD XDG_RUNTIME_DIR=$PWD QT_QPA_PLATFORM=offscreen QTWEBENGINE_DISABLE_SANDBOX=1 sh -ex commands </dev/null
}

# A file of single-precision samples that end with a sound: finite, within full scale, and not silent.
sounds() {
  tail -c 400000 "$1" | od -An -v -tf4 -w4 | awk -v file="$1" '
    { x = $1 < 0 ? -$1 : $1; if (!(x <= 1)) bad = 1; if (x > peak) peak = x }
    END { print file ": " NR " samples, largest " peak; exit bad || NR < 90000 || !(peak > 1e-3) }'
}
