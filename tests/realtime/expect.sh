#!/bin/sh
# A guard must catch: expect.sh caught MESSAGE PROGRAM STEP wants a failing status and the message (a regular expression),
# expect.sh clean MESSAGE PROGRAM STEP wants status 0 and the message.
wanted=$1 message=$2
shift 2
output=$("$@" 2>&1)
status=$?
echo "$output"
if [ "$wanted" = caught ] && [ $status -eq 0 ]; then
  echo "NOT CAUGHT: status 0"
  exit 1
fi
if [ "$wanted" = clean ] && [ $status -ne 0 ]; then
  echo "FALSE ALARM: status $status"
  exit 1
fi
echo "$output" | grep -Eq "$message" && exit 0
echo "status $status, but the output does not say: $message"
exit 1
