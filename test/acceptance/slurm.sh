#!/bin/sh
# Slurm's daemons for one machine, with everything of theirs in one folder:
#   slurm.sh start FOLDER   (SLURM_CONF is then FOLDER/slurm.conf)
#   slurm.sh stop FOLDER
# Needs the packages slurm-wlm and munge, and root for their accounts.
set -eu
action=$1
folder=$2
export SLURM_CONF=$folder/slurm.conf

stop() {
  for pid in "$folder/slurmctld.pid" "$folder/slurmd.pid" "$folder/munged.pid"; do
    [ -s "$pid" ] && kill "$(cat "$pid")" 2> /dev/null || true
  done
}

if [ "$action" = stop ]; then
  stop
  exit 0
fi

mkdir -p "$folder/state" "$folder/spool"
host=$(hostname -s)
cat > "$SLURM_CONF" << END
ClusterName=duet
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CredType=cred/munge
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
MpiDefault=none
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SchedulerParameters=batch_sched_delay=0,sched_interval=1,sched_min_interval=0
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
dd if=/dev/urandom of="$folder/munge.key" bs=64 count=1 2> /dev/null
chmod 600 "$folder/munge.key"
/usr/sbin/munged --force --key-file "$folder/munge.key" --socket "$folder/munge.socket" \
  --pid-file "$folder/munged.pid" --log-file "$folder/munged.log" \
  --seed-file "$folder/munge.seed"
/usr/sbin/slurmctld -f "$SLURM_CONF"
/usr/sbin/slurmd -f "$SLURM_CONF"
for _ in $(seq 100); do
  sinfo --noheader --format=%T 2> /dev/null | grep -q '^idle' && exit 0
  sleep 0.1
done
echo "no node has become idle" >&2
tail -n 5 "$folder"/*.log >&2
stop
exit 1
