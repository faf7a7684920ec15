# SPDX-License-Identifier: Apache-2.0
# Sourced by scripts that take packages of any architecture from the Debian mirror this machine uses,
# without touching what is installed here.

# start_archive ARCHITECTURE FOLDER: apt's own state in FOLDER/apt, of a machine with nothing
# installed, so that packages come with all their dependencies.
start_archive() {
  archive_architecture=$1
  archive=$2/apt
  rm -rf "$archive"
  mkdir -p "$archive/lists/partial" "$archive/cache/archives/partial"
  : >"$archive/status"
  archive_apt -o APT::Update::Error-Mode=any update || {
    echo "some lists of the Debian mirror cannot be fetched: continuing with the others" >&2
    touch "$archive/unread"
  }
}

# fetch_packages PACKAGE...: into $archive/cache/archives. Skips with 77 if they cannot be
# downloaded; fails if the part of the archive that could be read lacks one.
fetch_packages() {
  archive_apt install --simulate "$@" >/dev/null || {
    [ -e "$archive/unread" ] || exit 1
    echo "skipped: the Debian mirror cannot be reached"
    exit 77
  }
  archive_apt install --download-only --yes "$@" >/dev/null ||
    { echo "skipped: the Debian mirror cannot be reached"; exit 77; }
}

# start_source_archive FOLDER: the same for the source packages of the Debian repositories that this
# machine uses. fetch_source SOURCE_PACKAGE TARGET unpacks one, with Debian's patches, into TARGET.
start_source_archive() {
  apt-get indextargets --format 'deb-src $(SITE) $(RELEASE) $(COMPONENT)' \
    'Created-By: Packages' 'Origin: Debian' | sort -u >"$1/sources.list"
  archive_options=(-o Dir::Etc::SourceList="$1/sources.list" -o Dir::Etc::SourceParts=-)
  start_archive "$(dpkg --print-architecture)" "$1"
}
fetch_source() {
  (cd "$archive" && archive_apt source --only-source --download-only "$1" >/dev/null) ||
    { echo "skipped: the Debian mirror cannot be reached"; exit 77; }
  dpkg-source --no-check --extract "$archive/$1"_*.dsc "$2" >/dev/null
}

archive_options=()
archive_apt() {
  apt-get -qq -o Dir::State="$archive" -o Dir::State::status="$archive/status" \
    -o Dir::Cache="$archive/cache" -o APT::Architecture="$archive_architecture" \
    -o APT::Architectures="$archive_architecture" -o APT::Sandbox::User="$(id -un)" \
    -o Acquire::Languages=none -o Acquire::Retries=3 -o APT::Install-Recommends=false "${archive_options[@]}" "$@"
}
