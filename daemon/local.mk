# libdaemon, the machines behind the daemons
noinst_LIBRARIES += libdaemon.a
libdaemon_a_CPPFLAGS = $(AM_CPPFLAGS)
libdaemon_a_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS) $(SECCOMP_CFLAGS) $(JANSSON_CFLAGS) \
	$(SQLITE_CFLAGS)
libdaemon_a_SOURCES = \
	daemon/action.c \
	daemon/action.h \
	daemon/address.c \
	daemon/address.h \
	daemon/ambseen.c \
	daemon/ambseen.h \
	daemon/ambshare.c \
	daemon/ambshare.h \
	daemon/balance.c \
	daemon/blobs.c \
	daemon/blobs.h \
	daemon/cache.c \
	daemon/cache.h \
	daemon/children.c \
	daemon/children.h \
	daemon/conf.c \
	daemon/conf.h \
	daemon/conn.c \
	daemon/conn.h \
	daemon/coord.c \
	daemon/coord.h \
	daemon/coord_conn.c \
	daemon/coord_job.c \
	daemon/coord_keep.c \
	daemon/counted.c \
	daemon/counted.h \
	daemon/daemon.c \
	daemon/daemon.h \
	daemon/dial.c \
	daemon/dial.h \
	daemon/disk.c \
	daemon/disk.h \
	daemon/duplicate.c \
	daemon/estimate.c \
	daemon/estimate.h \
	daemon/fair.c \
	daemon/fair.h \
	daemon/fingerprint.c \
	daemon/fingerprint.h \
	daemon/filtered.c \
	daemon/filtered.h \
	daemon/folder.c \
	daemon/folder.h \
	daemon/folder_impl.h \
	daemon/folder_take.c \
	daemon/gate.c \
	daemon/gate.h \
	daemon/handoff.c \
	daemon/handshake.c \
	daemon/handshake.h \
	daemon/hold.c \
	daemon/hours.c \
	daemon/hours.h \
	daemon/idle.c \
	daemon/idle.h \
	daemon/introduce.c \
	daemon/job.c \
	daemon/job.h \
	daemon/jobtext.c \
	daemon/jobtext.h \
	daemon/journal.c \
	daemon/journal.h \
	daemon/journal_impl.h \
	daemon/journal_put.c \
	daemon/journal_read.c \
	daemon/keyring.c \
	daemon/keyring.h \
	daemon/known.c \
	daemon/known.h \
	daemon/lending.c \
	daemon/listen.c \
	daemon/listen.h \
	daemon/listing.c \
	daemon/listing.h \
	daemon/log.c \
	daemon/log.h \
	daemon/loss.c \
	daemon/lossy.c \
	daemon/lossy.h \
	daemon/mark.c \
	daemon/mark.h \
	daemon/owner.c \
	daemon/owner.h \
	daemon/partition.c \
	daemon/partition.h \
	daemon/partition_impl.h \
	daemon/partition_lines.c \
	daemon/partition_lines.h \
	daemon/partition_queue.c \
	daemon/partition_region.c \
	daemon/partition_run.c \
	daemon/partition_window.c \
	daemon/peer.c \
	daemon/peer.h \
	daemon/pool.c \
	daemon/pool.h \
	daemon/pool_first.c \
	daemon/pool_impl.h \
	daemon/pool_strict.c \
	daemon/pool_thread.c \
	daemon/pool_unit.c \
	daemon/quota.c \
	daemon/quota.h \
	daemon/recover.c \
	daemon/recover.h \
	daemon/relay.c \
	daemon/render.c \
	daemon/render.h \
	daemon/render_impl.h \
	daemon/render_load.c \
	daemon/render_records.c \
	daemon/render_units.c \
	daemon/report.c \
	daemon/report.h \
	daemon/request.c \
	daemon/request.h \
	daemon/result.c \
	daemon/ring.c \
	daemon/ring.h \
	daemon/room.c \
	daemon/room.h \
	daemon/rowcheck.c \
	daemon/rowcheck.h \
	daemon/rows.c \
	daemon/rows.h \
	daemon/rowsum.c \
	daemon/rowsum.h \
	daemon/sandbox.c \
	daemon/sandbox.h \
	daemon/saved.h \
	daemon/sched.c \
	daemon/sched.h \
	daemon/seeding.c \
	daemon/seeding.h \
	daemon/service.c \
	daemon/service.h \
	daemon/shared.c \
	daemon/shared.h \
	daemon/shell.c \
	daemon/shell.h \
	daemon/sound.c \
	daemon/sound.h \
	daemon/speed.c \
	daemon/spread.c \
	daemon/spread.h \
	daemon/statecheck.c \
	daemon/statecheck.h \
	daemon/statedir.c \
	daemon/statedir.h \
	daemon/stats.c \
	daemon/stats.h \
	daemon/store.c \
	daemon/store.h \
	daemon/store_arrive.c \
	daemon/store_files.c \
	daemon/store_impl.h \
	daemon/store_jobs.c \
	daemon/store_read.c \
	daemon/store_recover.c \
	daemon/store_rows.c \
	daemon/store_submit.c \
	daemon/strict.c \
	daemon/strict.h \
	daemon/strict_edge.c \
	daemon/strict_facts.c \
	daemon/strict_impl.h \
	daemon/strict_loan.c \
	daemon/strict_out.c \
	daemon/strict_pass.c \
	daemon/strict_unit.c \
	daemon/survey.c \
	daemon/survey.h \
	daemon/syncs.c \
	daemon/syncs.h \
	daemon/task.c \
	daemon/task.h \
	daemon/team.c \
	daemon/team.h \
	daemon/team_impl.h \
	daemon/team_lend.c \
	daemon/team_member.c \
	daemon/team_sweep.c \
	daemon/transfer.c \
	daemon/transfer.h \
	daemon/turns.c \
	daemon/turns.h \
	daemon/uploads.c \
	daemon/uploads.h \
	daemon/views.c \
	daemon/views.h \
	daemon/wordlist.c \
	daemon/wordlist.h \
	daemon/worker.c \
	daemon/worker.h \
	daemon/worker_child.c \
	daemon/worker_coord.c \
	daemon/worker_files.c \
	daemon/worker_impl.h \
	daemon/worker_job.c \
	daemon/yield.c

# what a program that uses libdaemon links with, before $(LIBRAD)
LIBDAEMON = libdaemon.a $(LIBPROTO) $(UV_LIBS) $(SECCOMP_LIBS) $(JANSSON_LIBS) \
	$(SQLITE_LIBS)

sbin_PROGRAMS += radcoord radd
radcoord_SOURCES = \
	daemon/radcoord.c \
	daemon/radcoord_conf.c \
	daemon/radcoord_conns.c \
	daemon/radcoord_impl.h \
	daemon/radcoord_keys.c \
	daemon/radcoord_store.c
radcoord_CPPFLAGS = $(AM_CPPFLAGS) -DSYSCONFDIR='"$(sysconfdir)"'
radcoord_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
radcoord_LDADD = $(LIBDAEMON) $(LIBRAD)
radd_SOURCES = daemon/radd.c
radd_CPPFLAGS = $(AM_CPPFLAGS) -DSYSCONFDIR='"$(sysconfdir)"'
radd_CFLAGS = $(AM_CFLAGS) $(UV_CFLAGS)
radd_LDADD = $(LIBDAEMON) $(LIBRAD)
