# What the guest runs in the place of an operating system's start: the scenarios, from a copy in memory.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin PYTHONPATH=/opt/canopen PYTHONDONTWRITEBYTECODE=1 HOME=/tmp
ip link set lo up
mkdir -p /var/tmp /run /dev/shm
mount -t tmpfs shm /dev/shm
cp -r /share/kernel /share/config /share/pneuservo /share/bare_loop /tmp/
cd /tmp/kernel && exec python3 guest.py
