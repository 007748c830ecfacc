#!/usr/bin/env bash
# Prints every pose of a SLAM sensor, from NMEA over TCP, with nothing but bash:
#   read_pose.sh [HOST [PORT]]
# A line per pose: time of day (UTC), status, x (m), y (m), heading (degrees, counter-clockwise from the map's x axis),
# number of the map, protection radius (m); those only where there is a fix, or the better of two places. gpsd users:
# gpspipe -w gives the same sensor as TPV and ATT.
set -uo pipefail
host=${1:-localhost}
port=${2:-10110}

# Whether the checksum behind the asterisk is that of what stands before it.
is_whole() {
  local body=${1#\$} sum=0 i code
  body=${body%%\**}
  for ((i = 0; i < ${#body}; ++i)); do
    printf -v code %d "'${body:i:1}"
    sum=$((sum ^ code))
  done
  printf -v code %02X "$sum"
  [[ ${1##*\*} == "$code" ]]
}

exec 3<>"/dev/tcp/$host/$port" || exit
while IFS= read -r line <&3; do
  line=${line%$'\r'}
  [[ $line == '$PSLMA,POSE,'* ]] && is_whole "$line" || continue
  IFS=, read -r _ _ time status _ _ x y heading _ _ _ _ _ _ map radius <<<"${line%\**}"
  case $status in
    A) echo "$time fix $x $y $heading $map $radius" ;;
    U) echo "$time ambiguous $x $y $heading $map $radius" ;;
    *) echo "$time no_fix" ;;
  esac
done
