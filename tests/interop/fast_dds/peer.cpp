// Fast DDS, which most of ROS 2 speaks by default: `peer rt/TOPIC EventPacket COUNT FILE` reads packets and
// saves their fields as JSON lines; `peer rt/TOPIC Image COUNT -` writes grey images of 24 x 16 pixels, one for
// each line of its input; with Raw instead of Image, the bytes that the line has in hex.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "messagesPubSubTypes.h"

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::Duration_t;
using Packet = event_camera_msgs::msg::dds_::EventPacket_;
using Image = sensor_msgs::msg::dds_::Image_;

// Bytes, whatever they are, under the name of a type.
struct Raw {
    std::vector<unsigned char> bytes;
};

class RawType : public TopicDataType {
public:
    RawType() {
        setName("sensor_msgs::msg::dds_::Image_");
        m_typeSize = 1 << 20;
    }
    bool serialize(void *data, eprosima::fastrtps::rtps::SerializedPayload_t *payload) override {
        const auto &bytes = static_cast<Raw *>(data)->bytes;
        std::copy(bytes.begin(), bytes.end(), payload->data);
        payload->length = static_cast<uint32_t>(bytes.size());
        return true;
    }
    bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t *, void *) override { return false; }
    std::function<uint32_t()> getSerializedSizeProvider(void *data) override {
        return [data] { return static_cast<uint32_t>(static_cast<Raw *>(data)->bytes.size()); };
    }
    void *createData() override { return new Raw; }
    void deleteData(void *data) override { delete static_cast<Raw *>(data); }
    bool getKey(void *, eprosima::fastrtps::rtps::InstanceHandle_t *, bool) override { return false; }
};

static const auto PATIENCE = std::chrono::seconds(30);

template <typename Condition> static void until(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + PATIENCE;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) std::exit(1);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

static void read(DomainParticipant *participant, Topic *topic, int count, const char *file) {
    DataReaderQos qos;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.history().kind = KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 1000;
    DataReader *reader = participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT)->create_datareader(topic, qos);
    until([&] {
        SubscriptionMatchedStatus status;
        reader->get_subscription_matched_status(status);
        return status.current_count > 0;
    });
    std::cout << "found" << std::endl;
    std::ofstream lines(file);
    for (int i = 0; i < count; ++i) {
        Packet packet;
        SampleInfo info;
        if (!reader->wait_for_unread_message(Duration_t(30, 0))) return;
        if (!(reader->take_next_sample(&packet, &info) == ReturnCode_t::RETCODE_OK)) return;
        std::string hex;
        char two[3];
        for (unsigned char each : packet.events_()) {
            std::snprintf(two, sizeof two, "%02x", each);
            hex += two;
        }
        lines << "{\"header_\": {\"stamp_\": {\"sec_\": " << packet.header_().stamp_().sec_()
              << ", \"nanosec_\": " << packet.header_().stamp_().nanosec_() << "}, \"frame_id_\": \""
              << packet.header_().frame_id_() << "\"}, \"height_\": " << packet.height_()
              << ", \"width_\": " << packet.width_() << ", \"seq_\": " << packet.seq_()
              << ", \"time_base_\": " << packet.time_base_() << ", \"encoding_\": \"" << packet.encoding_()
              << "\", \"is_bigendian_\": " << (packet.is_bigendian_() ? "true" : "false")
              << ", \"events_\": \"" << hex << "\"}\n";
    }
}

static Image image_of(int i) {
    Image image;
    image.header_().stamp_().sec_(1);
    image.header_().stamp_().nanosec_(10000000 * i);
    image.width_(24);
    image.height_(16);
    image.step_(24);
    image.encoding_("mono8");
    image.data_().assign(24 * 16, static_cast<unsigned char>(10 * i));
    return image;
}

static Raw raw_of(const std::string &hex) {
    Raw raw;
    for (size_t i = 0; i + 1 < hex.size(); i += 2)
        raw.bytes.push_back(static_cast<unsigned char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
    return raw;
}

static void write(DomainParticipant *participant, Topic *topic, int count, bool raw) {
    DataWriterQos qos;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    DataWriter *writer = participant->create_publisher(PUBLISHER_QOS_DEFAULT)->create_datawriter(topic, qos);
    until([&] {
        PublicationMatchedStatus status;
        writer->get_publication_matched_status(status);
        return status.current_count > 0;
    });
    std::cout << "found" << std::endl;
    std::string line;
    for (int i = 0; i < count && std::getline(std::cin, line); ++i) {
        Image image = image_of(i);
        Raw bytes = raw ? raw_of(line) : Raw();
        writer->write(raw ? static_cast<void *>(&bytes) : static_cast<void *>(&image));
        std::cout << "one" << std::endl;
    }
    writer->wait_for_acknowledgments(Duration_t(10, 0));
}

int main(int argc, char **argv) {
    if (argc != 5) return 2;
    const bool packets = std::string(argv[2]) == "EventPacket", raw = std::string(argv[2]) == "Raw";
    const int domain = std::atoi(std::getenv("ROS_DOMAIN_ID"));
    DomainParticipant *participant =
        DomainParticipantFactory::get_instance()->create_participant(domain, PARTICIPANT_QOS_DEFAULT);
    TypeSupport type(packets ? static_cast<TopicDataType *>(new event_camera_msgs::msg::dds_::EventPacket_PubSubType())
                     : raw   ? static_cast<TopicDataType *>(new RawType())
                             : static_cast<TopicDataType *>(new sensor_msgs::msg::dds_::Image_PubSubType()));
    type.register_type(participant);
    Topic *topic = participant->create_topic(argv[1], type.get_type_name(), TOPIC_QOS_DEFAULT);
    if (packets)
        read(participant, topic, std::atoi(argv[3]), argv[4]);
    else
        write(participant, topic, std::atoi(argv[3]), raw);
    std::cout << "done" << std::endl;
    std::_Exit(0);
}
