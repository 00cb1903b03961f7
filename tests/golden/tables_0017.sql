CREATE TABLE audit (
    id INTEGER NOT NULL,
    at DATETIME NOT NULL,
    course VARCHAR(64),
    actor VARCHAR(64) NOT NULL,
    action VARCHAR(64) NOT NULL,
    subject VARCHAR(255) NOT NULL,
    "before" TEXT NOT NULL,
    "after" TEXT NOT NULL,
    reason TEXT NOT NULL,
    PRIMARY KEY (id)
);

CREATE INDEX audit_course ON audit (course, id);

CREATE TABLE course (
    id VARCHAR(64) NOT NULL,
    title VARCHAR(200) NOT NULL,
    time_zone VARCHAR(64) NOT NULL,
    created_at DATETIME NOT NULL,
    distro VARCHAR(32) DEFAULT 'humble' NOT NULL,
    archived_at DATETIME,
    PRIMARY KEY (id)
);

CREATE TABLE graded_assignment (
    sha256 VARCHAR(64) NOT NULL,
    content BLOB NOT NULL,
    PRIMARY KEY (sha256)
);

CREATE TABLE platform_key (
    id VARCHAR(64) NOT NULL,
    secret TEXT NOT NULL,
    created_at DATETIME NOT NULL,
    PRIMARY KEY (id)
);

CREATE TABLE recognised (
    sha256 VARCHAR(64) NOT NULL,
    provider VARCHAR(64) NOT NULL,
    subject VARCHAR(255) NOT NULL,
    expires_at DATETIME NOT NULL,
    PRIMARY KEY (sha256)
);

CREATE TABLE source (
    sha256 VARCHAR(64) NOT NULL,
    content BLOB NOT NULL,
    PRIMARY KEY (sha256)
);

CREATE TABLE used_message (
    sha256 VARCHAR(64) NOT NULL,
    expires_at DATETIME NOT NULL,
    PRIMARY KEY (sha256)
);

CREATE TABLE worker (
    id VARCHAR(255) NOT NULL,
    slots INTEGER NOT NULL,
    busy INTEGER NOT NULL,
    sandbox_ready BOOLEAN NOT NULL,
    isolation VARCHAR(64) NOT NULL,
    detail TEXT NOT NULL,
    started_at DATETIME NOT NULL,
    seen_at DATETIME NOT NULL,
    PRIMARY KEY (id)
);

CREATE TABLE mail_wishes (
    course VARCHAR(64) NOT NULL,
    due BOOLEAN NOT NULL,
    graded BOOLEAN NOT NULL,
    faults BOOLEAN NOT NULL,
    changed_at DATETIME NOT NULL,
    PRIMARY KEY (course),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE TABLE member (
    course VARCHAR(64) NOT NULL,
    person VARCHAR(64) NOT NULL,
    name VARCHAR(200) NOT NULL,
    role VARCHAR(32) NOT NULL,
    created_at DATETIME NOT NULL,
    email VARCHAR(254) DEFAULT '' NOT NULL,
    PRIMARY KEY (course, person),
    CONSTRAINT member_role CHECK (role IN ('student', 'assistant', 'instructor')),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE TABLE notice (
    id VARCHAR(32) NOT NULL,
    course VARCHAR(64) NOT NULL,
    outlet VARCHAR(16) NOT NULL,
    kind VARCHAR(16) NOT NULL,
    person VARCHAR(64) NOT NULL,
    heading TEXT NOT NULL,
    body TEXT NOT NULL,
    made_at DATETIME NOT NULL,
    until DATETIME NOT NULL,
    not_before DATETIME NOT NULL,
    sent_at DATETIME,
    tries INTEGER NOT NULL,
    code VARCHAR(16) NOT NULL,
    trouble TEXT NOT NULL,
    PRIMARY KEY (id),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE INDEX notice_course ON notice (course, made_at);

CREATE TABLE own_assignment (
    course VARCHAR(64) NOT NULL,
    assignment VARCHAR(64) NOT NULL,
    number INTEGER NOT NULL,
    version INTEGER NOT NULL,
    state VARCHAR(16) NOT NULL,
    content BLOB NOT NULL,
    reading BLOB NOT NULL,
    examined BLOB NOT NULL,
    uploaded_at DATETIME NOT NULL,
    uploaded_by VARCHAR(64) NOT NULL,
    not_before DATETIME NOT NULL,
    lease_until DATETIME,
    tries INTEGER NOT NULL,
    trouble TEXT NOT NULL,
    PRIMARY KEY (course, assignment, number),
    CONSTRAINT own_assignment_state CHECK (state IN ('waiting', 'ready', 'refused')),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE INDEX own_assignment_waiting ON own_assignment (state, uploaded_at);

CREATE TABLE platform (
    id VARCHAR(16) NOT NULL,
    course VARCHAR(64) NOT NULL,
    title VARCHAR(200) NOT NULL,
    issuer VARCHAR(255) NOT NULL,
    client_id VARCHAR(255) NOT NULL,
    deployment VARCHAR(255) NOT NULL,
    login_url VARCHAR(1000) NOT NULL,
    token_url VARCHAR(1000) NOT NULL,
    keys_url VARCHAR(1000) NOT NULL,
    people_url VARCHAR(1000) DEFAULT '' NOT NULL,
    created_at DATETIME NOT NULL,
    PRIMARY KEY (id),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE UNIQUE INDEX platform_client ON platform (issuer, client_id, deployment);

CREATE TABLE platform_invitation (
    sha256 VARCHAR(64) NOT NULL,
    course VARCHAR(64) NOT NULL,
    actor VARCHAR(64) NOT NULL,
    until DATETIME NOT NULL,
    PRIMARY KEY (sha256),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE TABLE regrade (
    id VARCHAR(16) NOT NULL,
    course VARCHAR(64),
    assignment VARCHAR(64) NOT NULL,
    state VARCHAR(16) NOT NULL,
    wanted TEXT NOT NULL,
    created_at DATETIME NOT NULL,
    created_by VARCHAR(64) NOT NULL,
    decided_at DATETIME,
    decided_by VARCHAR(64) NOT NULL,
    reason TEXT NOT NULL,
    outcome TEXT NOT NULL,
    undone_at DATETIME,
    undone_by VARCHAR(64) DEFAULT '' NOT NULL,
    undone_reason TEXT DEFAULT '' NOT NULL,
    PRIMARY KEY (id),
    CONSTRAINT regrade_state CHECK (state IN ('open', 'applied', 'discarded', 'undone')),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE TABLE rules (
    course VARCHAR(64) NOT NULL,
    assignment VARCHAR(64) NOT NULL,
    document TEXT NOT NULL,
    changed_at DATETIME NOT NULL,
    PRIMARY KEY (course, assignment),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE TABLE told (
    course VARCHAR(64) NOT NULL,
    outlet VARCHAR(16) NOT NULL,
    person VARCHAR(64) NOT NULL,
    about VARCHAR(128) NOT NULL,
    state VARCHAR(64) NOT NULL,
    PRIMARY KEY (course, outlet, person, about),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE TABLE webhook (
    course VARCHAR(64) NOT NULL,
    outlet VARCHAR(16) NOT NULL,
    vendor VARCHAR(16) NOT NULL,
    address VARCHAR(1000) NOT NULL,
    secret VARCHAR(200) NOT NULL,
    changed_at DATETIME NOT NULL,
    PRIMARY KEY (course, outlet),
    FOREIGN KEY(course) REFERENCES course (id)
);

CREATE TABLE extension (
    course VARCHAR(64) NOT NULL,
    assignment VARCHAR(64) NOT NULL,
    person VARCHAR(64) NOT NULL,
    due DATETIME,
    extra_attempts INTEGER NOT NULL,
    PRIMARY KEY (course, assignment, person),
    FOREIGN KEY(course, person) REFERENCES member (course, person)
);

CREATE TABLE identity (
    id VARCHAR(16) NOT NULL,
    provider VARCHAR(64) NOT NULL,
    subject VARCHAR(255) NOT NULL,
    course VARCHAR(64) NOT NULL,
    person VARCHAR(64) NOT NULL,
    bound_at DATETIME NOT NULL,
    by_token BOOLEAN NOT NULL,
    PRIMARY KEY (id),
    FOREIGN KEY(course, person) REFERENCES member (course, person)
);

CREATE UNIQUE INDEX identity_subject ON identity (provider, subject, course);

CREATE TABLE platform_link (
    platform VARCHAR(16) NOT NULL,
    resource VARCHAR(255) NOT NULL,
    title VARCHAR(255) NOT NULL,
    assignment VARCHAR(64) NOT NULL,
    line_item VARCHAR(2000) NOT NULL,
    used_at DATETIME NOT NULL,
    PRIMARY KEY (platform, resource),
    FOREIGN KEY(platform) REFERENCES platform (id)
);

CREATE TABLE platform_picking (
    sha256 VARCHAR(64) NOT NULL,
    platform VARCHAR(16) NOT NULL,
    subject VARCHAR(255) NOT NULL,
    back TEXT NOT NULL,
    data TEXT NOT NULL,
    several BOOLEAN NOT NULL,
    scored BOOLEAN NOT NULL,
    until DATETIME NOT NULL,
    PRIMARY KEY (sha256),
    FOREIGN KEY(platform) REFERENCES platform (id)
);

CREATE TABLE section (
    course VARCHAR(64) NOT NULL,
    person VARCHAR(64) NOT NULL,
    section VARCHAR(64) NOT NULL,
    PRIMARY KEY (course, person, section),
    FOREIGN KEY(course, person) REFERENCES member (course, person)
);

CREATE TABLE submission (
    id VARCHAR(36) NOT NULL,
    course VARCHAR(64),
    student VARCHAR(64) NOT NULL,
    assignment VARCHAR(64) NOT NULL,
    file_name VARCHAR(255) NOT NULL,
    source_sha256 VARCHAR(64) NOT NULL,
    size_bytes INTEGER NOT NULL,
    state VARCHAR(32) NOT NULL,
    priority INTEGER NOT NULL,
    received_at DATETIME NOT NULL,
    queued_at DATETIME NOT NULL,
    turn_at DATETIME NOT NULL,
    not_before DATETIME NOT NULL,
    started_at DATETIME,
    finished_at DATETIME,
    lease_until DATETIME,
    worker VARCHAR(255) NOT NULL,
    attempt INTEGER NOT NULL,
    tries INTEGER NOT NULL,
    trouble TEXT NOT NULL,
    graded_attempt INTEGER,
    verdict VARCHAR(32),
    score FLOAT,
    max_score FLOAT,
    report_sha256 VARCHAR(64),
    regrade VARCHAR(16),
    original VARCHAR(36),
    to_judge INTEGER,
    PRIMARY KEY (id),
    CONSTRAINT submission_state CHECK (state IN ('queued', 'running', 'graded', 'infrastructure_error')),
    CONSTRAINT running_has_a_lease CHECK (state != 'running' OR lease_until IS NOT NULL),
    FOREIGN KEY(course) REFERENCES course (id),
    FOREIGN KEY(source_sha256) REFERENCES source (sha256),
    FOREIGN KEY(regrade) REFERENCES regrade (id),
    FOREIGN KEY(original) REFERENCES submission (id)
);

CREATE INDEX submission_class ON submission (course, student, assignment, received_at);

CREATE INDEX submission_finished ON submission (finished_at);

CREATE INDEX submission_lately ON submission (course, student, finished_at);

CREATE INDEX submission_original ON submission (original);

CREATE INDEX submission_queue ON submission (state, priority, turn_at, id, queued_at);

CREATE INDEX submission_regrade ON submission (regrade);

CREATE TABLE token (
    id VARCHAR(16) NOT NULL,
    sha256 VARCHAR(64) NOT NULL,
    course VARCHAR(64) NOT NULL,
    person VARCHAR(64) NOT NULL,
    created_at DATETIME NOT NULL,
    expires_at DATETIME NOT NULL,
    revoked_at DATETIME,
    opened_by VARCHAR(16),
    PRIMARY KEY (id),
    FOREIGN KEY(course, person) REFERENCES member (course, person),
    UNIQUE (sha256)
);

CREATE INDEX token_owner ON token (course, person);

CREATE TABLE appeal (
    submission_id VARCHAR(36) NOT NULL,
    item VARCHAR(128) NOT NULL,
    reason TEXT NOT NULL,
    made_at DATETIME NOT NULL,
    attempt INTEGER NOT NULL,
    earned FLOAT NOT NULL,
    points FLOAT NOT NULL,
    state VARCHAR(16) NOT NULL,
    answer TEXT NOT NULL,
    answered_by VARCHAR(64) NOT NULL,
    answered_at DATETIME,
    seen_at DATETIME,
    PRIMARY KEY (submission_id, item),
    CONSTRAINT appeal_state CHECK (state IN ('open', 'answered', 'corrected', 'refused', 'withdrawn')),
    FOREIGN KEY(submission_id) REFERENCES submission (id)
);

CREATE INDEX appeal_waiting ON appeal (state, made_at);

CREATE TABLE comment (
    submission_id VARCHAR(36) NOT NULL,
    number INTEGER NOT NULL,
    written_by VARCHAR(64) NOT NULL,
    by_student BOOLEAN NOT NULL,
    line INTEGER,
    text TEXT NOT NULL,
    written_at DATETIME NOT NULL,
    seen_at DATETIME,
    PRIMARY KEY (submission_id, number),
    FOREIGN KEY(submission_id) REFERENCES submission (id)
);

CREATE TABLE grading (
    submission_id VARCHAR(36) NOT NULL,
    attempt INTEGER NOT NULL,
    worker VARCHAR(255) NOT NULL,
    finished_at DATETIME NOT NULL,
    grader_version VARCHAR(64) NOT NULL,
    assignment_version INTEGER NOT NULL,
    verdict VARCHAR(32) NOT NULL,
    score FLOAT,
    max_score FLOAT NOT NULL,
    report_sha256 VARCHAR(64) NOT NULL,
    report BLOB NOT NULL,
    measurements TEXT NOT NULL,
    assignment_sha256 VARCHAR(64),
    regrade VARCHAR(16),
    replaced INTEGER,
    PRIMARY KEY (submission_id, attempt),
    FOREIGN KEY(submission_id) REFERENCES submission (id),
    FOREIGN KEY(assignment_sha256) REFERENCES graded_assignment (sha256),
    FOREIGN KEY(regrade) REFERENCES regrade (id)
);

CREATE INDEX grading_regrade ON grading (regrade);

CREATE TABLE platform_score (
    platform VARCHAR(16) NOT NULL,
    resource VARCHAR(255) NOT NULL,
    course VARCHAR(64) NOT NULL,
    person VARCHAR(64) NOT NULL,
    sha256 VARCHAR(64) NOT NULL,
    sent_at DATETIME,
    not_before DATETIME NOT NULL,
    tries INTEGER NOT NULL,
    trouble TEXT NOT NULL,
    PRIMARY KEY (platform, resource, person),
    FOREIGN KEY(platform, resource) REFERENCES platform_link (platform, resource),
    FOREIGN KEY(course, person) REFERENCES member (course, person)
);

CREATE TABLE told_change (
    submission_id VARCHAR(36) NOT NULL,
    regrade VARCHAR(16) NOT NULL,
    undone BOOLEAN NOT NULL,
    change TEXT NOT NULL,
    at DATETIME NOT NULL,
    seen_at DATETIME,
    PRIMARY KEY (submission_id, regrade, undone),
    FOREIGN KEY(submission_id) REFERENCES submission (id),
    FOREIGN KEY(regrade) REFERENCES regrade (id)
);

CREATE TABLE upload_key (
    owner VARCHAR(160) NOT NULL,
    "key" VARCHAR(255) NOT NULL,
    digest VARCHAR(64) NOT NULL,
    submission_id VARCHAR(36) NOT NULL,
    at DATETIME NOT NULL,
    PRIMARY KEY (owner, "key"),
    FOREIGN KEY(submission_id) REFERENCES submission (id)
);

CREATE INDEX upload_key_submission ON upload_key (submission_id);

CREATE TABLE graded_item (
    submission_id VARCHAR(36) NOT NULL,
    attempt INTEGER NOT NULL,
    item VARCHAR(128) NOT NULL,
    status VARCHAR(32) NOT NULL,
    points FLOAT NOT NULL,
    earned FLOAT NOT NULL,
    PRIMARY KEY (submission_id, attempt, item),
    FOREIGN KEY(submission_id, attempt) REFERENCES grading (submission_id, attempt)
);

CREATE TABLE graded_mistake (
    submission_id VARCHAR(36) NOT NULL,
    attempt INTEGER NOT NULL,
    code VARCHAR(64) NOT NULL,
    rank INTEGER NOT NULL,
    PRIMARY KEY (submission_id, attempt, code),
    FOREIGN KEY(submission_id, attempt) REFERENCES grading (submission_id, attempt)
);

CREATE TABLE judgement (
    submission_id VARCHAR(36) NOT NULL,
    item VARCHAR(128) NOT NULL,
    revision INTEGER NOT NULL,
    points FLOAT NOT NULL,
    out_of FLOAT NOT NULL,
    comment TEXT NOT NULL,
    judged_by VARCHAR(64) NOT NULL,
    judged_at DATETIME NOT NULL,
    attempt INTEGER NOT NULL,
    source_sha256 VARCHAR(64) NOT NULL,
    PRIMARY KEY (submission_id, item, revision),
    FOREIGN KEY(submission_id, attempt) REFERENCES grading (submission_id, attempt),
    CONSTRAINT judgement_points CHECK (points >= 0 AND points <= out_of),
    FOREIGN KEY(source_sha256) REFERENCES source (sha256)
);

CREATE TABLE trajectory (
    submission_id VARCHAR(36) NOT NULL,
    attempt INTEGER NOT NULL,
    case_id VARCHAR(64) NOT NULL,
    position INTEGER NOT NULL,
    sha256 VARCHAR(64) NOT NULL,
    content BLOB NOT NULL,
    PRIMARY KEY (submission_id, attempt, case_id),
    FOREIGN KEY(submission_id, attempt) REFERENCES grading (submission_id, attempt)
);
